// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/excursions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "flight/probes/sequence.hpp"
#include "numerics/order_statistics.hpp"

namespace sepcal::checks {
namespace {

using numerics::select_quantile;

/// New readings of a stretch, each against its neighbours.
struct Readings {
  RowList rows;
  std::vector<double> values;
  std::vector<double> errors;  // from the median of two before and two after; 0 at the ends
  std::size_t end = 0;         // of the stretch
};

Readings compare_neighbours(std::span<const double> column, const Segment& stretch) {
  Readings all;
  all.end = stretch.last;
  all.rows = probes::find_new_rows(column, stretch);
  for (const std::size_t row : all.rows) all.values.push_back(column[row]);
  all.errors.assign(all.rows.size(), 0.0);
  const std::vector<double>& x = all.values;
  for (std::size_t k = 2; k + 2 < x.size(); ++k) {
    std::array around{x[k - 2], x[k - 1], x[k + 1], x[k + 2]};
    std::ranges::sort(around);
    all.errors[k] = x[k] - 0.5 * (around[1] + around[2]);
  }
  return all;
}

/// What is usual near a reading: the 85 % point of the errors within ten readings of it, itself and
/// those that it spoils left out.
double usual_near(const std::vector<double>& errors, std::size_t k) {
  constexpr std::size_t reach = 12;
  constexpr std::size_t spoiled = 2;
  std::vector<double> near;
  for (std::size_t j = k < reach ? 0 : k - reach; j < std::min(k + reach + 1, errors.size()); ++j) {
    if (j + spoiled < k || j > k + spoiled) near.push_back(std::abs(errors[j]));
  }
  if (near.empty()) return infinity;
  return select_quantile(near, 0.85);
}

/// How far it is from the reading beside k, on that side, to the next; to the one beyond where the
/// next is off by itself, as of two spikes with a good reading between.
double way_beside(const std::vector<double>& x, const std::vector<double>& errors, std::size_t k,
                  int side, double off) {
  const auto at = [&](int away) {
    return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(k) + std::ptrdiff_t{side} * away);
  };
  const bool has_beyond = side < 0 ? k >= 3 : k + 3 < x.size();
  const bool is_off = has_beyond && std::abs(errors[at(2)]) > off;
  return std::abs(x[at(1)] - x[at(is_off ? 3 : 2)]);
}

/// A spike goes and comes back: it stands on one side of both neighbours, by half of its error and
/// by twice the way from these to the next, which a turn does not.
bool is_spike(const std::vector<double>& x, const std::vector<double>& errors, std::size_t k,
              double off) {
  const double before = x[k] - x[k - 1];
  const double after = x[k] - x[k + 1];
  const double way = std::max(way_beside(x, errors, k, -1, off), way_beside(x, errors, k, 1, off));
  const double least = std::max(0.5 * std::abs(errors[k]), 2 * way);
  return before * after > 0 && std::min(std::abs(before), std::abs(after)) > least;
}

void add_rows(RowList& rows, const Readings& part, std::size_t first, std::size_t last) {
  const std::size_t end = last < part.rows.size() ? part.rows[last] : part.end;
  for (std::size_t row = part.rows[first]; row < end; ++row) rows.push_back(row);
}

/// A reading that is kept for long is where the column rests, as a speed at zero.
bool is_rest(const Readings& part, std::size_t k, const Manner& manner) {
  constexpr std::size_t brief = 3;
  return manner.rests && part.values[k] == 0 && k + 1 < part.rows.size() &&
         part.rows[k + 1] - part.rows[k] > brief;
}

/// Readings beyond eight robust standard deviations of all, and six times what is usual near them.
void find_spikes(const std::vector<Readings>& stretches, double scale, const Manner& manner,
                 Excursions& found) {
  double square = 0.0;
  double all = 0.0;
  for (const Readings& part : stretches) {
    for (std::size_t k = 2; k + 2 < part.rows.size(); ++k) {
      const double error = std::abs(part.errors[k]);
      all += error * error;
      if (!(error > 8 * scale) || !is_spike(part.values, part.errors, k, 8 * scale)) continue;
      if (!(error > 6 * usual_near(part.errors, k)) || is_rest(part, k, manner)) continue;
      add_rows(found.spikes, part, k, k + 1);
      found.farthest_spike = std::max(found.farthest_spike, error);
      square += error * error;
    }
  }
  if (all > 0) found.spike_share = square / all;
}

constexpr std::size_t longest_burst = 30;  // readings

/// The reading at which a burst that begins at k is over, and the least of its two jumps; 0 where
/// none begins there. All of its readings stand off the line from the last before to the first
/// after by half a jump, and these two are near one another.
struct Burst {
  std::size_t end = 0;
  double jump = 0.0;
};

Burst find_burst(const std::vector<double>& x, std::size_t k) {
  const double away = x[k] - x[k - 1];
  for (std::size_t m = k + 2; m < std::min(k + longest_burst + 1, x.size()); ++m) {
    const double back = x[m - 1] - x[m];
    if (!(away * back > 0)) continue;
    const double jump = std::min(std::abs(away), std::abs(back));
    if (std::max(std::abs(away), std::abs(back)) > 2.5 * jump) continue;
    if (!(std::abs(x[m] - x[k - 1]) < 0.35 * jump)) continue;
    const auto off = [&](std::size_t i) {
      const double share = static_cast<double>(i - k + 1) / static_cast<double>(m - k + 1);
      return std::abs(x[i] - x[k - 1] - share * (x[m] - x[k - 1])) > 0.5 * jump;
    };
    bool all = true;
    for (std::size_t i = k; i < m && all; ++i) all = off(i);
    if (all) return {m, jump};
  }
  return {};
}

/// What neighbours differ by beside readings [k, m): the 85 % point within twelve on either side.
double usual_beside(const std::vector<double>& x, std::size_t k, std::size_t m) {
  constexpr std::size_t reach = 12;
  std::vector<double> near;
  for (std::size_t j = k < reach + 1 ? 1 : k - reach; j < k; ++j) {
    near.push_back(std::abs(x[j] - x[j - 1]));
  }
  for (std::size_t j = m + 1; j < std::min(m + reach + 1, x.size()); ++j) {
    near.push_back(std::abs(x[j] - x[j - 1]));
  }
  if (near.size() < reach) return infinity;
  return select_quantile(near, 0.85);
}

/// As a spike is judged. A column that jumps as far and stays there does so by itself.
void find_bursts(const std::vector<Readings>& stretches, double scale, Excursions& found) {
  struct Place {
    const Readings* part;
    std::size_t first;
    std::size_t last;
  };
  std::vector<Place> places;
  double least = infinity;
  for (const Readings& part : stretches) {
    const std::vector<double>& x = part.values;
    for (std::size_t k = 3; k + 3 < x.size(); ++k) {
      const double away = std::abs(x[k] - x[k - 1]);
      const double before = std::max(std::abs(x[k - 1] - x[k - 2]), std::abs(x[k - 2] - x[k - 3]));
      if (!(away > 8 * scale) || !(away > 2.5 * before)) continue;
      const Burst burst = find_burst(x, k);
      if (burst.end == 0 || !(burst.jump > 8 * scale)) continue;
      if (!(burst.jump > 6 * usual_beside(x, k, burst.end))) continue;
      places.push_back({&part, k, burst.end});
      least = std::min(least, burst.jump);
      found.farthest_burst = std::max(found.farthest_burst, away);
      k = burst.end;
    }
  }
  if (places.empty()) return;
  std::size_t stays = 0;
  for (const Readings& part : stretches) {
    for (std::size_t k = 1; k < part.values.size(); ++k) {
      if (std::abs(part.values[k] - part.values[k - 1]) < 0.7 * least) continue;
      const bool within = std::ranges::any_of(places, [&](const Place& place) {
        return place.part == &part && k >= place.first && k <= place.last;
      });
      if (!within && !std::ranges::binary_search(found.spikes, part.rows[k]) &&
          !std::ranges::binary_search(found.spikes, part.rows[k] - 1)) {
        ++stays;
      }
    }
  }
  if (stays >= places.size()) return;
  for (const Place& place : places) add_rows(found.bursts, *place.part, place.first, place.last);
}

std::vector<Readings> read(std::span<const double> values, const std::vector<Segment>& stretches) {
  std::vector<Readings> parts;
  for (const Segment& stretch : stretches) parts.push_back(compare_neighbours(values, stretch));
  return parts;
}

double noise_of(const std::vector<Readings>& parts) {
  constexpr std::size_t fewest = 200;  // readings, of which what is usual can be told
  std::vector<double> errors;
  for (const Readings& part : parts) {
    for (const double error : part.errors) errors.push_back(std::abs(error));
  }
  return errors.size() < fewest ? not_a_number : 1.4826 * select_quantile(errors, 0.5);
}

}  // namespace

double reading_noise(std::span<const double> values, const std::vector<Segment>& stretches) {
  return noise_of(read(values, stretches));
}

Excursions find_excursions(std::span<const double> values, const std::vector<Segment>& stretches,
                           const Manner& manner) {
  const std::vector<Readings> parts = read(values, stretches);
  const double noise = noise_of(parts);
  if (std::isnan(noise)) return {};
  Excursions found;
  find_spikes(parts, noise, manner, found);
  if (manner.flows) find_bursts(parts, noise, found);
  if (found.spikes.empty() && found.bursts.empty()) return {};
  const probes::Sequence sequence = probes::find_sequence(values, stretches);
  if (sequence.knot_spacing > 1.0) return {};  // a spike is a triangle there
  if (!(sequence.step > noise)) return found;
  Excursions on_steps;
  find_spikes(parts, sequence.step, manner, on_steps);
  if (manner.flows) find_bursts(parts, sequence.step, on_steps);
  return on_steps;
}

}  // namespace sepcal::checks
