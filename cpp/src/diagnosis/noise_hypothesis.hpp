// SPDX-License-Identifier: BSD-3-Clause
// A hypothesis: the residual is a combination of some columns plus noise, each output's with a
// model of its own, all estimated together by maximum likelihood. Two nested ones give the
// likelihood ratio of what the larger has more.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/linearisation.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal::diagnosis {

inline constexpr double least_sigma = 1e-9;  // of the RMSE: nothing at all can't be whitened

using NoiseModels = std::vector<NoiseModel>;  // of each used output, in units of its RMSE

struct Hypothesis {
  NoiseModels noise = {};
  double minus_two_log_likelihood = 0.0;
  Eigen::VectorXd coefficients = {};  // of the columns
  Eigen::MatrixXd covariance = {};    // of the coefficients, in that noise
};

/// The innovations' standard deviation over all outputs, in their unit: what no model of the past
/// predicts better.
double noise_floor(const RowLayout& layout, const NoiseModels& noise);

/// The noise models of a residual (count() rows), of free order.
NoiseModels fit_noise_models(const RowLayout& layout, const Eigen::VectorXd& residual);

/// Whether slow effects could hide in it.
bool is_coloured(const NoiseModel& noise);

/// White models of the same order and freedom of the level: another start of the search.
NoiseModels forget_colour(NoiseModels noise);

/// Whitens columns of count() rows, output by output.
void whiten(const RowLayout& layout, const NoiseModels& noise, Eigen::MatrixXd& columns);

/// Of a symmetric matrix that is not negative. A free level of the noise leaves constants
/// undetermined: such directions stay zero.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& square);

/// Columns in one noise model, whitened once for many residuals.
class WhitenedColumns {
 public:
  /// `layout` and `columns` (about orthonormal) must outlive it.
  WhitenedColumns(const RowLayout& layout, const Eigen::MatrixXd& columns,
                  const NoiseModels& noise);

  /// Generalised least squares of a residual on the columns, and its covariance.
  Eigen::VectorXd estimate(const Eigen::VectorXd& residual) const;
  const Eigen::MatrixXd& covariance() const { return covariance_; }

  /// That estimate, and the noise model of what it leaves, of the same order. The search ends where
  /// another step would gain less than `least_gain` in -2 ln L; with `afresh` it begins a second
  /// time without colour. Without the covariance.
  Hypothesis step(const Eigen::VectorXd& residual, double least_gain, bool afresh) const;

 private:
  const RowLayout& layout_;
  NoiseModels noise_;
  const Eigen::MatrixXd& columns_;
  Eigen::MatrixXd white_;
  Eigen::MatrixXd covariance_;
};

/// Steps until they gain nothing, from the best of `starts`, whose orders are kept.
Hypothesis maximise(const RowLayout& layout, const Eigen::MatrixXd& columns,
                    const Eigen::VectorXd& residual, const std::vector<NoiseModels>& starts);

}  // namespace sepcal::diagnosis
