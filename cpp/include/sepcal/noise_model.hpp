// SPDX-License-Identifier: BSD-3-Clause
// The noise of one output: phi(B) (1 - B)^d e = sigma w, with B the shift by one row, w white of
// unit variance and phi(B) = 1 - phi_1 B - ... - phi_p B^p. White noise is d = 0 and p = 0, pink
// noise d = 0.5, a slow drift d near 1. Segments are independent of each other.
#pragma once

#include <memory>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// With a free level nothing is assumed of the mean of a segment: only differences within it have a
/// distribution, and each segment's first row carries no information. For d >= 0.5 the noise has no
/// finite variance and the level is always free (from 1e-6 below on: the variance is lost in
/// rounding there). The differences know no border at d = 0.5.
struct NoiseModel {
  double d = 0.0;            // in [0, 1)
  Eigen::VectorXd phi = {};  // p coefficients of a stationary autoregression
  double sigma = 1.0;        // standard deviation of the innovations, in the unit of e
  bool free_level = false;

  int order() const { return static_cast<int>(phi.size()); }
  bool level_is_free() const { return free_level || d >= 0.5 - 1e-6; }
};

struct NoiseFitOptions {
  /// Order p, at most a tenth of the rows and a quarter of the longest segment; empty: the one of
  /// least AIC (corrected for few rows) up to max_order and that limit.
  std::optional<int> order = {};
  int max_order = 8;

  /// An earlier fit: its order and its freedom of the level are kept, so that the two -2 ln L are
  /// of nested models. `order` and `max_order` are not used.
  std::optional<NoiseModel> start = {};

  /// The search ends where another step would gain less in -2 ln L.
  double least_gain = 1e-4;
};

struct NoiseFit {
  NoiseModel model;
  /// -2 ln L at the model, L the Gaussian likelihood (with a free level: of the differences).
  /// -infinity where sigma = 0. Comparable between fits of equal free_level and rows.
  double minus_two_log_likelihood = 0.0;
  Eigen::Index informative_rows = 0;  // rows, less one for each segment where the level is free
  int evaluations = 0;                // of the likelihood
  bool converged = true;              // another step would gain less than least_gain
};

/// Maximum likelihood. `e` has one value for each row of the record; rows outside the segments are
/// not read. The level is free where the differences are fitted best by d >= 0.45; else its mean is
/// taken for zero and d is at most 0.49: a mean far from zero is then read as slow noise.
///
/// Where the segments leave no difference that is not zero (constant or zero e, a row a segment) or
/// fewer than eight differences, the noise is white: d = 0, p = 0, sigma the root mean square of e,
/// which may be 0. Throws Error for no rows, a segment that leaves `e`, a value that is not finite,
/// a negative order and a start that is no noise model.
NoiseFit fit_noise(std::span<const double> e, const std::vector<Segment>& segments,
                   const NoiseFitOptions& options = {});

/// The rows of the segments of `e`, one segment after another. Throws Error where one leaves `e`.
Eigen::VectorXd gather_rows(std::span<const double> e, const std::vector<Segment>& segments);

namespace noise {
class ArfimaFactor;
}  // namespace noise

/// W with W'W = Sigma^-1, Sigma the covariance of the noise: W e is white with unit variance. Only
/// the lengths and the sequence of the segments count. Const and safe to share between threads.
class Whitener {
 public:
  /// Throws Error for d outside [0, 1), phi that is not stationary or too near to it, a sigma that
  /// is not positive (a residual of zeros has nothing to whiten) and an empty segment.
  Whitener(const NoiseModel& model, const std::vector<Segment>& segments);

  Eigen::Index rows() const { return rows_; }
  Eigen::Index informative_rows() const { return informative_rows_; }

  /// ln det Sigma; of the differences where the level is free. -2 ln L of a residual e is this
  /// + |W e|^2 + informative_rows() ln(2 pi).
  double log_determinant() const { return log_determinant_; }

  /// Whitens in place columns of rows() rows, one segment after another (gather_rows' layout).
  /// Where the level is free each segment's first row becomes zero. Exact but for rounding for p =
  /// 0 and to 1e-3 of one row's variance a segment otherwise; each row then depends on those before
  /// it, the first p rows of a segment on all. Throws Error for another number of rows.
  void apply(Eigen::Ref<Eigen::MatrixXd> columns) const;

 private:
  std::vector<Eigen::Index> lengths_;  // rows of each segment
  std::shared_ptr<const noise::ArfimaFactor> factor_;
  double sigma_;
  bool free_level_;
  Eigen::Index rows_ = 0;
  Eigen::Index informative_rows_ = 0;
  double log_determinant_ = 0.0;
};

/// Draws of the noise: an independent one in each column, segment after segment (rows x draws).
/// Where the level is free the noise begins at zero as many rows before a segment as the segment
/// has. `innovations`, where given (rows of them, whitened residuals): their sizes are kept and
/// their signs drawn, so that bursts stay where they are; zeros are drawn as normals. Throws Error
/// as Whitener does; sigma may be 0.
Eigen::MatrixXd simulate_noise(const NoiseModel& model, const std::vector<Segment>& segments,
                               Eigen::Index draws, std::mt19937_64& generator,
                               const Eigen::VectorXd& innovations = {});

/// X' Sigma X (q x q) of columns X (rows x q, gather_rows' layout), Sigma the covariance of what
/// simulate_noise draws. Throws Error as Whitener does (sigma may be 0) and for other rows.
Eigen::MatrixXd covariance_product(const NoiseModel& model, const std::vector<Segment>& segments,
                                   const Eigen::Ref<const Eigen::MatrixXd>& X);

}  // namespace sepcal
