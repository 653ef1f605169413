// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/driver_origin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sepcal::exporting {

double origin_of(const Interval& range) {
  constexpr double far = 4.0;
  const double span = range.upper - range.lower;
  const double largest = std::max(std::abs(range.lower), std::abs(range.upper));
  if (!(largest > far * span)) return 0.0;
  const double middle = range.lower + 0.5 * span;
  if (span == 0.0) return middle;
  const double decimals = -std::floor(std::log10(0.5 * span));
  const double step = std::pow(10.0, std::abs(decimals));
  // A power of ten below one is no double: to divide by one above rounds once.
  return decimals > 0.0 ? std::round(middle * step) / step : std::round(middle / step) * step;
}

std::string number_text(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::string whole_of(const std::string& less_origin, double origin) {
  if (origin == 0.0) return less_origin;
  return fmt::format("({} + {})", number_text(origin), less_origin);
}

std::vector<double> powers_about(double origin, int power) {
  std::vector<double> coefficients{1.0};
  for (int k = 0; k < power; ++k) {
    coefficients.push_back(coefficients.back());
    for (std::size_t j = coefficients.size() - 2; j > 0; --j) {
      coefficients[j] = origin * coefficients[j] + coefficients[j - 1];
    }
    coefficients[0] *= origin;
  }
  return coefficients;
}

std::string horner(const std::string& c, std::size_t first, std::size_t last,
                   const std::string& d) {
  std::string text = fmt::format("{}[{}]", c, last);
  for (std::size_t j = last; j > first; --j) {
    const char* const form = j == last ? "{}[{}] + {} * {}" : "{}[{}] + {} * ({})";
    text = fmt::format(fmt::runtime(form), c, j - 1, d, text);
  }
  return text;
}

}  // namespace sepcal::exporting
