// SPDX-License-Identifier: BSD-3-Clause
#include "model/smooth_inputs.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

namespace sepcal::model {
namespace {

using Eigen::ArrayXd;
using Eigen::Index;

/// The size of white noise by differences of fourth order, which motion hardly has; robust.
double noise_of(std::span<const double> x) {
  constexpr double robust = 1.4826;
  constexpr double of_differences = 70.0;  // 1 + 16 + 36 + 16 + 1
  std::vector<double> sizes;
  sizes.reserve(x.size());
  for (std::size_t i = 4; i < x.size(); ++i) {
    sizes.push_back(std::abs(x[i] - 4.0 * (x[i - 1] + x[i - 3]) + 6.0 * x[i - 2] + x[i - 4]));
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::ranges::nth_element(sizes, middle);
  return robust * *middle / std::sqrt(of_differences);
}

/// Least squares of a quadratic over 2 h + 1 values.
class LocalQuadratic {
 public:
  explicit LocalQuadratic(Index h)
      : h_(h), k_(ArrayXd::LinSpaced(2 * h + 1, -static_cast<double>(h), static_cast<double>(h))) {
    const auto count = static_cast<double>(k_.size());
    second_ = k_.square().sum();
    fourth_ = k_.square().square().sum();
    determinant_ = count * fourth_ - second_ * second_;
  }

  /// What a value counts in its own smooth one, within the window's middle.
  double own_weight() const { return fourth_ / determinant_; }

  ArrayXd smooth(const ArrayXd& x) const {
    const auto count = static_cast<double>(k_.size());
    ArrayXd y(x.size());
    for (Index i = 0; i < x.size(); ++i) {
      const Index middle = std::clamp<Index>(i, h_, x.size() - 1 - h_);
      const auto window = x.segment(middle - h_, k_.size());
      const double sum = window.sum();
      const double square = (window * k_.square()).sum();
      const auto at = static_cast<double>(i - middle);
      y[i] = (fourth_ * sum - second_ * square) / determinant_ +
             at * (window * k_).sum() / second_ +
             at * at * (count * square - second_ * sum) / determinant_;
    }
    return y;
  }

 private:
  Index h_;
  ArrayXd k_;
  double second_ = 0.0;  // sums of k^2 and k^4
  double fourth_ = 0.0;
  double determinant_ = 0.0;
};

/// Less whole turns, so that no angle jumps from the one before; returns what each is less by.
std::vector<double> unwrap(std::vector<double>& angles) {
  std::vector<double> turns(angles.size(), 0.0);
  for (std::size_t i = 1; i < angles.size(); ++i) {
    const double before = angles[i - 1];
    const double whole = before + std::remainder(angles[i] - before, 2.0 * std::numbers::pi);
    turns[i] = angles[i] - whole;
    angles[i] = whole;
  }
  return turns;
}

}  // namespace

std::vector<double> smooth(std::span<const double> x) {
  constexpr std::array<Index, 5> half_windows{2, 4, 8, 16, 32};
  constexpr Index fewest = 40;
  std::vector<double> best(x.begin(), x.end());
  const Eigen::Map<const ArrayXd> given(x.data(), static_cast<Index>(x.size()));
  if (given.size() < fewest || !given.allFinite()) return best;
  const double noise = noise_of(x);
  const double variance = noise * noise;
  double least = variance;  // of the values as they are
  for (const Index h : half_windows) {
    if (2 * h + 1 > given.size()) break;
    const LocalQuadratic quadratic(h);
    const ArrayXd y = quadratic.smooth(given);
    const double risk =
        (y - given).square().mean() + (2.0 * quadratic.own_weight() - 1.0) * variance;
    if (!(risk < least)) continue;
    least = risk;
    std::ranges::copy(y, best.begin());
  }
  return best;
}

Record smooth_inputs(const Record& record, const Tables& tables) {
  Record smoothed = record;
  for (const Variable& input : tables.inputs) {
    const bool is_output =
        std::ranges::find(tables.outputs, input.name, &Variable::name) != tables.outputs.end();
    if (input.name == "time" || is_output || !record.has(input.name)) continue;
    const auto column = record.column(input.name);
    std::vector<double> values(column.begin(), column.end());
    const std::vector<double> turns =
        input.unit == "rad" ? unwrap(values) : std::vector<double>(values.size(), 0.0);
    for (const Segment& segment : record.segments()) {
      const std::span<double> rows(values.data() + segment.first, segment.rows());
      std::ranges::copy(smooth(rows), rows.begin());
    }
    std::ranges::transform(values, turns, values.begin(), std::plus<>());
    smoothed.replace(input.name, std::move(values));
  }
  return smoothed;
}

}  // namespace sepcal::model
