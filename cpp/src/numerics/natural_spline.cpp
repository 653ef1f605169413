// SPDX-License-Identifier: BSD-3-Clause
// With curvatures c_i at the knots, h_i = x_{i+1} - x_i and c_0 = c_last = 0, a continuous slope
// asks
//   h_{i-1} c_{i-1} + 2 (h_{i-1} + h_i) c_i + h_i c_{i+1}
//     = 6 [(y_{i+1} - y_i)/h_i - (y_i - y_{i-1})/h_{i-1}],
// which is tridiagonal and diagonally dominant.
#include "sepcal/detail/natural_spline.hpp"

#include <algorithm>
#include <cmath>

#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::RowVectorXd;

void check_knots(const std::vector<double>& knots, std::size_t fewest) {
  if (knots.size() < fewest) {
    throw Error("a spline has " + std::to_string(knots.size()) + " knots; it needs at least " +
                std::to_string(fewest));
  }
  for (std::size_t i = 1; i < knots.size(); ++i) {
    if (knots[i] > knots[i - 1] && std::isfinite(knots[i] - knots[i - 1])) continue;
    throw Error("a spline's knots must increase; knot " + std::to_string(i + 1) +
                " is not above the one before it");
  }
}

/// Curvatures at the knots of the spline through `values`: one elimination down, one back.
std::vector<double> solve_curvatures(const std::vector<double>& knots,
                                     const std::vector<double>& values) {
  const std::size_t last = knots.size() - 1;
  std::vector<double> curvatures(knots.size(), 0.0);
  std::vector<double> above(knots.size(), 0.0);
  for (std::size_t i = 1; i < last; ++i) {
    const double before = knots[i] - knots[i - 1];
    const double after = knots[i + 1] - knots[i];
    const double turn =
        6.0 * ((values[i + 1] - values[i]) / after - (values[i] - values[i - 1]) / before);
    const double pivot = 2.0 * (before + after) - before * above[i - 1];
    above[i] = after / pivot;
    curvatures[i] = (turn - before * curvatures[i - 1]) / pivot;
  }
  for (std::size_t i = last - 1; i > 0; --i) curvatures[i] -= above[i] * curvatures[i + 1];
  return curvatures;
}

/// The interval whose cubic holds at x; the first or last one beyond the ends.
std::size_t find_interval(const std::vector<double>& knots, double x) {
  const auto above = std::upper_bound(knots.begin() + 1, knots.end() - 1, x);
  return static_cast<std::size_t>(above - knots.begin()) - 1;
}

}  // namespace

NaturalSpline::NaturalSpline(std::vector<double> knots, std::vector<double> values)
    : knots_(std::move(knots)), values_(std::move(values)) {
  check_knots(knots_, 2);
  if (values_.size() != knots_.size()) throw Error("a spline needs one value at each knot");
  curvatures_ = solve_curvatures(knots_, values_);
}

NaturalSpline::Value NaturalSpline::at(double x) const {
  return within(find_interval(knots_, x), x);
}

NaturalSpline::Value NaturalSpline::at(double x, std::size_t& hint) const {
  const std::size_t last = knots_.size() - 2;
  hint = std::min(hint, last);
  while (hint < last && x > knots_[hint + 1]) ++hint;
  while (hint > 0 && x < knots_[hint]) --hint;
  return within(hint, x);
}

NaturalSpline::Value NaturalSpline::within(std::size_t interval, double x) const {
  const std::size_t i = interval;
  const double h = knots_[i + 1] - knots_[i];
  const double rise = (values_[i + 1] - values_[i]) / h;
  const double left = curvatures_[i];
  const double right = curvatures_[i + 1];
  const double inside = std::clamp(x, knots_.front(), knots_.back());
  const double t = inside - knots_[i];
  const double slope_left = rise - h * (2.0 * left + right) / 6.0;
  const double third = (right - left) / h;
  const double slope = slope_left + t * (left + 0.5 * t * third);
  const double value = values_[i] + t * (slope_left + t * (0.5 * left + t * third / 6.0));
  const double beyond = x - inside;
  return {value + beyond * slope, slope, beyond == 0.0 ? left + t * third : 0.0};
}

std::vector<double> even_knots(double lowest, double highest, int count) {
  if (count < 2) throw Error("a spline has " + std::to_string(count) + " knots; it needs two");
  std::vector<double> knots(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / (count - 1);
    knots[static_cast<std::size_t>(i)] = lowest + share * (highest - lowest);
  }
  knots.back() = highest;  // to the last digit
  check_knots(knots, 2);
  return knots;
}

SplineBasis::SplineBasis(std::vector<double> knots) : knots_(std::move(knots)) {
  check_knots(knots_, 3);
  const auto count = static_cast<Index>(knots_.size());
  curvatures_.resize(count, count);
  for (Index j = 0; j < count; ++j) {
    std::vector<double> unit(knots_.size(), 0.0);
    unit[static_cast<std::size_t>(j)] = 1.0;
    const std::vector<double> column = solve_curvatures(knots_, unit);
    for (Index i = 0; i < count; ++i) curvatures_(i, j) = column[static_cast<std::size_t>(i)];
  }
}

void SplineBasis::evaluate(double x, Eigen::Ref<RowVectorXd> values) const {
  const std::size_t i = find_interval(knots_, x);
  const auto row = static_cast<Index>(i);
  const double h = knots_[i + 1] - knots_[i];
  const double inside = std::clamp(x, knots_.front(), knots_.back());
  const double right = (inside - knots_[i]) / h;
  const double left = 1.0 - right;
  const double beyond = x - inside;
  // Shares of the curvatures in the value and, past the ends, in the slope.
  const double curvature_left =
      h * h / 6.0 * (left * left * left - left) + beyond * h / 6.0 * (1.0 - 3.0 * left * left);
  const double curvature_right = h * h / 6.0 * (right * right * right - right) +
                                 beyond * h / 6.0 * (3.0 * right * right - 1.0);
  values = curvature_left * curvatures_.row(row).rightCols(functions()) +
           curvature_right * curvatures_.row(row + 1).rightCols(functions());
  if (row > 0) values[row - 1] += left - beyond / h;
  values[row] += right + beyond / h;
}

SplineBasis::Cubic SplineBasis::piece_of(int function, std::size_t piece) const {
  const auto own = static_cast<std::size_t>(function) + 1;  // the knot where it is one
  const std::size_t i = std::clamp<std::size_t>(piece, 1, knots_.size() - 1) - 1;
  const double h = knots_[i + 1] - knots_[i];
  const double here = i == own ? 1.0 : 0.0;
  const double next = i + 1 == own ? 1.0 : 0.0;
  const double left = curvatures_(static_cast<Index>(i), function + 1);
  const double right = curvatures_(static_cast<Index>(i) + 1, function + 1);
  const double slope = (next - here) / h - h * (2.0 * left + right) / 6.0;
  if (piece == 0) return {knots_.front(), {here, slope, 0.0, 0.0}};
  if (piece == knots_.size()) {
    return {knots_.back(), {next, slope + 0.5 * h * (left + right), 0.0, 0.0}};
  }
  return {knots_[i], {here, slope, 0.5 * left, (right - left) / (6.0 * h)}};
}

}  // namespace sepcal
