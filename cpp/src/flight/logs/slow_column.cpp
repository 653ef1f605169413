// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/slow_column.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/gaps.hpp"
#include "flight/files/invalid_cells.hpp"
#include "flight/files/units.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/error.hpp"

namespace sepcal::logs {
namespace {

constexpr std::array widths{3.0, 4.0, 6.0, 8.0, 12.0};  // of a parabola, in usual intervals
constexpr double as_good = 1.02;  // squares of predictions' errors, over the least

}  // namespace

Joining parse_joining(const std::string& how) {
  if (how == "smooth") return Joining::smooth;
  if (how == "linear") return Joining::linear;
  if (how == "held") return Joining::held;
  throw OptionError({Option{"join"}, " is smooth, linear or held, not '" + how + "'"});
}

double turn_of(const std::string& header) {
  const std::size_t split = header.rfind('_');
  if (split == std::string::npos) return 0.0;
  const files::Unit* unit = files::find_unit(files::UnitKind::angle, header.substr(split + 1));
  return unit == nullptr ? 0.0 : 2.0 * std::numbers::pi / unit->convert(1.0);
}

SlowColumn::SlowColumn(std::span<const double> time, std::span<const double> values,
                       Joining joining, double turn)
    : joining_(joining), interval_(not_a_number) {
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
  unwrap(turn);
  if (!intervals.empty()) interval_ = base::usual_interval(intervals);
  cut_at_gaps(base::find_gap(std::move(intervals)));
  if (joining_ == Joining::smooth && samples() > 1) choose_width();
}

/// Samples of an angle that jumps, without jumps; at() brings them back into the turn.
void SlowColumn::unwrap(double turn) {
  if (!(turn > 0.0) || joining_ == Joining::held) return;
  const bool is_signed = std::ranges::any_of(values_, [](double value) { return value < 0.0; });
  double turns = 0.0;
  double before = values_.empty() ? 0.0 : values_.front();
  for (double& value : values_) {
    const double jump = value - before;
    before = value;
    if (std::abs(jump) > turn / 2.0) turns -= std::round(jump / turn);
    if (turns != 0.0) turn_ = turn;
    value += turns * turn;
  }
  lowest_ = is_signed ? -turn / 2.0 : 0.0;
}

void SlowColumn::cut_at_gaps(double gap) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < time_.size(); ++i) {
    if (i > 0 && time_[i] - time_[i - 1] > gap) begin = i;
    stretches_.push_back(begin);
  }
}

double SlowColumn::at(double time) const {
  const auto found = std::ranges::lower_bound(time_, time);
  if (found == time_.end()) return not_a_number;
  const auto after = static_cast<std::size_t>(found - time_.begin());
  const bool is_sample = *found == time;
  if (!is_sample && (after == 0 || stretches_[after] == after)) return not_a_number;
  double value = 0.0;
  if (joining_ == Joining::smooth) {
    value = on_parabola(after, time);
  } else if (is_sample) {
    value = values_[after];
  } else {
    value = joining_ == Joining::held ? values_[after - 1] : on_line(after, time);
  }
  return turn_ > 0.0 ? value - std::floor((value - lowest_) / turn_) * turn_ : value;
}

double SlowColumn::on_line(std::size_t after, double time) const {
  const double share = (time - time_[after - 1]) / (time_[after] - time_[after - 1]);
  return values_[after - 1] + share * (values_[after] - values_[after - 1]);
}

/// Where too few samples are near for a parabola, on the line.
double SlowColumn::on_parabola(std::size_t after, double time) const {
  const double value = fit_parabola(after, time, width_).value;
  if (std::isfinite(value)) return value;
  return time_[after] == time ? values_[after] : on_line(after, time);
}

/// By the samples of the stretch of `near` within the width [s]; NaN where they are fewer than
/// four.
SlowColumn::Fitted SlowColumn::fit_parabola(std::size_t near, double time, double width) const {
  constexpr int fewest = 4;
  const std::size_t stretch = stretches_[near];
  std::size_t first = near;
  while (first > stretch && time - time_[first - 1] < width) --first;
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3d products = Eigen::Vector3d::Zero();
  int count = 0;
  for (std::size_t i = first; i < time_.size() && stretches_[i] == stretch; ++i) {
    const double x = (time_[i] - time) / width;
    if (x >= 1.0) break;
    const double within = 1.0 - x * x;
    if (!(within > 0.0)) continue;
    const Eigen::Vector3d powers(1.0, x, x * x);
    const double weight = within * within * within;
    squares += weight * powers * powers.transpose();
    products += weight * (values_[i] - values_[near]) * powers;
    ++count;
  }
  if (count < fewest) return {not_a_number, not_a_number};
  const Eigen::LDLT<Eigen::Matrix3d> solver(squares);
  return {values_[near] + solver.solve(products)[0], solver.solve(Eigen::Vector3d::UnitX())[0]};
}

/// The mean square by which a sample lies off the parabola of the others.
double SlowColumn::prediction_error(double width) const {
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < time_.size(); ++i) {
    const auto [value, own_weight] = fit_parabola(i, time_[i], width);
    if (!std::isfinite(value) || !(own_weight < 1.0)) continue;
    const double error = (values_[i] - value) / (1.0 - own_weight);
    sum += error * error;
    ++count;
  }
  return count == 0 ? infinity : sum / static_cast<double>(count);
}

/// The widest that predicts about as well as the best: the less noise a parabola keeps, the less
/// its slope's is taken for what a shift in time would do.
void SlowColumn::choose_width() {
  std::array<double, widths.size()> errors{};
  std::ranges::transform(widths, errors.begin(),
                         [this](double w) { return prediction_error(w * interval_); });
  const double best = std::ranges::min(errors);
  std::size_t chosen = widths.size() - 1;
  while (chosen > 0 && !(errors[chosen] <= as_good * best)) --chosen;
  width_ = widths[chosen] * interval_;
}

}  // namespace sepcal::logs
