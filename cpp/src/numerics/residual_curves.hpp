// SPDX-License-Identifier: BSD-3-Clause
// What pictures of a residual show: its autocorrelation, its spectrum, its quantiles, and its mean
// along another quantity.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/natural_spline.hpp"
#include "sepcal/record.hpp"

namespace sepcal::numerics {

/// Points of a curve, x and y of one length.
struct Curve {
  std::vector<double> x;
  std::vector<double> y;
};

/// Correlation of a residual with itself, a point a lag.
struct Autocorrelation {
  std::vector<double> lags;    // [rows]: from 1 to a third of the longest run, even in log lag
  std::vector<double> values;  // NaN where the residual does not vary or a lag has no pair
  std::vector<double> limits;  // within +-these white noise keeps 95 % of its values
};

/// Of `residual` (N) about its mean, from products within `runs` (of the N rows) alone. Mean
/// products, so that a run's ends count no less at long lags.
Autocorrelation find_autocorrelation(const Eigen::VectorXd& residual,
                                     const std::vector<Segment>& runs);

/// Welch's one-sided power density [unit^2/Hz] over frequency [Hz], averaged into 120 bins that are
/// even in log frequency: Hann windows of the longest run, 4096 rows at most, that overlap by half
/// within `runs`. `interval`: the sampling's [s].
Curve find_spectrum(const Eigen::VectorXd& residual, const std::vector<Segment>& runs,
                    double interval);

/// Quantiles of the residual (y) over the standard normal's (x) at the same shares, 200 of them at
/// most, denser in the tails, where they matter.
Curve find_quantiles(const Eigen::VectorXd& residual);

/// Means of x and y (N each, finite) in `bins` even bins of x that hold five points or more.
Curve bin_means(const Eigen::VectorXd& x, const Eigen::VectorXd& y, int bins);

inline constexpr int smooth_knots = 6;  // even, from the lowest to the highest x

/// The spline's functions at every x (N), (N, functions()).
Eigen::MatrixXd spline_columns(const SplineBasis& spline, const Eigen::VectorXd& x);

/// A natural spline through a cloud of points, at 80 even x; NaN far from any point.
struct Smooth {
  Eigen::VectorXd x;
  Eigen::VectorXd mean;
  Eigen::VectorXd half_width;  // two standard errors
};

/// Least squares of y over x (N each; a row with one that is not finite is passed over). The band
/// allows for correlated neighbours: the coefficients' covariance is (B'B)^-1 B' S B (B'B)^-1, S
/// the autocovariance of what the spline leaves, tapered (Bartlett) to a quarter of the rows.
/// Nothing where x does not vary.
std::optional<Smooth> fit_smooth(const Eigen::VectorXd& x, const Eigen::VectorXd& y);

}  // namespace sepcal::numerics
