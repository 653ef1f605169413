// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/regression_spline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "sepcal/detail/quantity.hpp"

namespace sepcal::numerics {
namespace {

constexpr std::size_t order = 4;  // of a cubic: so many basis functions overlap

/// The basis functions that are not zero at a time, from the first on.
struct BasisAt {
  std::size_t first;
  std::array<double, order> values;
};

/// Cubic B-splines on even knots from the first time to the last.
class EvenSpline {
 public:
  EvenSpline(std::span<const double> times, double spacing)
      : begin_(times.front()),
        pieces_(std::max(1.0, std::round((times.back() - times.front()) / spacing))),
        width_((times.back() - times.front()) / pieces_) {}

  std::size_t functions() const { return static_cast<std::size_t>(pieces_) + order - 1; }

  BasisAt at(double time) const {
    const double from_begin = (time - begin_) / width_;
    const double piece = std::clamp(std::floor(from_begin), 0.0, pieces_ - 1.0);
    const double x = from_begin - piece;
    const double y = 1.0 - x;
    return {static_cast<std::size_t>(piece),
            {y * y * y / 6.0, (3.0 * x * x * x - 6.0 * x * x + 4.0) / 6.0,
             (3.0 * y * y * y - 6.0 * y * y + 4.0) / 6.0, x * x * x / 6.0}};
  }

 private:
  double begin_;
  double pieces_;
  double width_;
};

/// Row i holds the elements (i, i), (i + 1, i), ... (i + 3, i) of a symmetric matrix.
using Bands = std::vector<std::array<double, order>>;

/// Solves bands * x = right, where the bands are positive definite, by L D L'.
std::vector<double> solve(Bands bands, std::vector<double> right) {
  const std::size_t n = bands.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t below = std::min(order, n - i);
    const std::array<double, order> column = bands[i];
    for (std::size_t k = 1; k < below; ++k) {
      const double share = column[k] / column[0];
      for (std::size_t j = k; j < below; ++j) bands[i + k][j - k] -= share * column[j];
      bands[i][k] = share;
      right[i + k] -= share * right[i];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    right[i] /= bands[i][0];
    for (std::size_t k = 1; k < std::min(order, n - i); ++k) {
      right[i] -= bands[i][k] * right[i + k];
    }
  }
  return right;
}

bool is_long_enough(const Stretch& stretch, double spacing) {
  return stretch.times.size() > order &&
         EvenSpline(stretch.times, spacing).functions() < stretch.times.size();
}

/// Of values about their mean.
double sum_squares(std::span<const double> values) {
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return sum;
}

}  // namespace

std::vector<double> fit_spline(const Stretch& stretch, double spacing) {
  const auto [times, values] = stretch;
  if (!is_long_enough(stretch, spacing)) return {values.begin(), values.end()};
  const EvenSpline spline(times, spacing);
  Bands bands(spline.functions(), {0.0, 0.0, 0.0, 0.0});
  std::vector<double> right(spline.functions(), 0.0);
  const double level = values[values.size() / 2];  // few digits are lost about it
  for (std::size_t row = 0; row < times.size(); ++row) {
    const auto [first, basis] = spline.at(times[row]);
    for (std::size_t i = 0; i < order; ++i) {
      right[first + i] += basis[i] * (values[row] - level);
      for (std::size_t j = i; j < order; ++j) bands[first + i][j - i] += basis[i] * basis[j];
    }
  }
  constexpr double of_a_sample = 1e-12;  // where no sample lies near a function
  for (auto& row : bands) row[0] += of_a_sample;
  const std::vector<double> shares = solve(std::move(bands), std::move(right));
  std::vector<double> fitted(times.size(), level);
  for (std::size_t row = 0; row < times.size(); ++row) {
    const auto [first, basis] = spline.at(times[row]);
    for (std::size_t i = 0; i < order; ++i) fitted[row] += basis[i] * shares[first + i];
  }
  return fitted;
}

double choose_spacing(const std::vector<Stretch>& stretches, double interval) {
  static constexpr std::array spacings{2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0};
  constexpr double rounding = 1e-20;  // of squares: what is left is none of noise
  double size = 0.0;
  for (const Stretch& stretch : stretches) size += sum_squares(stretch.values);
  double best = infinity;
  double chosen = 0.0;
  for (const double intervals : spacings) {
    double squares = 0.0;
    double rows = 0.0;
    double freedom = 0.0;
    for (const Stretch& stretch : stretches) {
      const double spacing = intervals * interval;
      if (!is_long_enough(stretch, spacing)) continue;
      const std::vector<double> fitted = fit_spline(stretch, spacing);
      for (std::size_t row = 0; row < fitted.size(); ++row) {
        const double rest = stretch.values[row] - fitted[row];
        squares += rest * rest;
      }
      rows += static_cast<double>(fitted.size());
      freedom +=
          static_cast<double>(fitted.size() - EvenSpline(stretch.times, spacing).functions());
    }
    if (!(squares > rounding * size)) return 0.0;
    const double error = rows * squares / (freedom * freedom);
    if (!(error < best)) continue;
    best = error;
    chosen = intervals;
  }
  return chosen > spacings.front() ? chosen * interval : 0.0;
}

}  // namespace sepcal::numerics
