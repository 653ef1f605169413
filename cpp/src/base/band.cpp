// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/band.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/short_number.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using base::short_number;

namespace {

/// first, first + spacing ... first + steps spacing; fewer than none where the band holds none.
struct Steps {
  double first, spacing, steps;
};

Steps steps_of(const Band& band, double seconds) {
  constexpr double rounding = 1e-9;
  const double spacing = band.spacing > 0.0 ? band.spacing : 1.0 / seconds;
  const double first =
      band.spacing > 0.0 ? band.low : spacing * std::ceil(band.low / spacing - rounding);
  return {first, spacing, std::floor((band.high - first) / spacing + rounding)};
}

}  // namespace

void check_band(const Band& band) {
  const bool finite =
      std::isfinite(band.low) && std::isfinite(band.high) && std::isfinite(band.spacing);
  if (!finite || band.low <= 0.0 || band.high <= band.low) {
    throw Error("a band from " + short_number(band.low) + " to " + short_number(band.high) +
                " Hz is none; give a lower frequency above 0 and a higher one, as 0.1 and 2 Hz");
  }
  if (band.spacing < 0.0) {
    throw Error("frequencies can't be " + short_number(band.spacing) +
                " Hz apart; give a spacing above 0, or 0 for one over the length of the flight");
  }
}

std::vector<double> frequencies_of(const Band& band, double seconds) {
  check_band(band);
  constexpr double most = 1e5;
  const auto [first, spacing, steps] = steps_of(band, seconds);
  if (!(steps >= 1.0)) {
    throw Error("a band from " + short_number(band.low) + " to " + short_number(band.high) +
                " Hz holds less than two frequencies " + short_number(spacing) +
                " Hz apart, as a segment of " + short_number(seconds) +
                " s has them; widen the band or give a longer flight");
  }
  if (steps > most) {
    throw Error("a band from " + short_number(band.low) + " to " + short_number(band.high) +
                " Hz holds more than 100000 frequencies " + short_number(spacing) +
                " Hz apart; narrow the band, or give a wider spacing");
  }
  std::vector<double> frequencies;
  for (std::size_t k = 0; static_cast<double>(k) <= steps; ++k) {
    frequencies.push_back(first + static_cast<double>(k) * spacing);
  }
  return frequencies;
}

std::vector<std::vector<double>> frequencies_of(const Band& band,
                                                const std::vector<double>& seconds) {
  check_band(band);
  std::vector<std::vector<double>> all(seconds.size());
  const auto longest = std::ranges::max_element(seconds);
  for (std::size_t s = 0; s < seconds.size(); ++s) {
    const bool is_longest = seconds.begin() + static_cast<std::ptrdiff_t>(s) == longest;
    if (is_longest || steps_of(band, seconds[s]).steps >= 1.0) {
      all[s] = frequencies_of(band, seconds[s]);
    }
  }
  return all;
}

}  // namespace sepcal
