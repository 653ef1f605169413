// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/slow_column.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/gaps.hpp"
#include "flight/files/invalid_cells.hpp"
#include "flight/files/units.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/error.hpp"

namespace sepcal::logs {

Joining parse_joining(const std::string& how) {
  if (how == "linear") return Joining::linear;
  if (how == "held") return Joining::held;
  throw OptionError({Option{"join"}, " is linear or held, not '" + how + "'"});
}

double turn_of(const std::string& header) {
  const std::size_t split = header.rfind('_');
  if (split == std::string::npos) return 0.0;
  const files::Unit* unit = files::find_unit(files::UnitKind::angle, header.substr(split + 1));
  return unit == nullptr ? 0.0 : 2.0 * std::numbers::pi / unit->convert(1.0);
}

SlowColumn::SlowColumn(std::span<const double> time, std::span<const double> values, double turn)
    : turn_(turn), interval_(not_a_number), gap_(infinity) {
  std::vector<double> intervals;
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (!files::is_reading(values[row]) || !files::is_reading(time[row])) continue;
    if (!time_.empty()) {
      if (!(time[row] > time_.back())) continue;
      intervals.push_back(time[row] - time_.back());
    }
    time_.push_back(time[row]);
    values_.push_back(values[row]);
  }
  if (!values_.empty() && std::ranges::min(values_) < 0.0) lowest_ = -turn_ / 2.0;
  if (intervals.empty()) return;
  interval_ = base::usual_interval(intervals);
  gap_ = base::find_gap(std::move(intervals));
}

double SlowColumn::at(double time, Joining joining) const {
  const auto found = std::ranges::lower_bound(time_, time);
  if (found == time_.end()) return not_a_number;
  const auto after = static_cast<std::size_t>(found - time_.begin());
  if (*found == time) return values_[after];
  if (after == 0 || time_[after] - time_[after - 1] > gap_) return not_a_number;
  return joining == Joining::held ? values_[after - 1] : between(after, time);
}

/// An angle that began anew goes the short way and stays within its turn.
double SlowColumn::between(std::size_t after, double time) const {
  const double share = (time - time_[after - 1]) / (time_[after] - time_[after - 1]);
  const double before = values_[after - 1];
  double step = values_[after] - before;
  if (!(turn_ > 0.0) || std::abs(step) <= turn_ / 2.0) return before + share * step;
  step -= std::round(step / turn_) * turn_;
  const double value = before + share * step;
  return value - std::floor((value - lowest_) / turn_) * turn_;
}

}  // namespace sepcal::logs
