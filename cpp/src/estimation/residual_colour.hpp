// SPDX-License-Identifier: BSD-3-Clause
// The colour of residuals: which noise model each output's has, if it is not white, and what that
// makes of the covariance of a score.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "base/thread_pool.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal::estimation {

/// Whether a row tells nothing of the next.
bool is_white(const NoiseModel& noise);

/// The noise of an output's residual `e`, or nothing where there is none to tell: fewer than 30
/// rows, or a residual of zeros. White where nothing else is better by BIC.
std::optional<NoiseModel> find_residual_noise(std::span<const double> e,
                                              const std::vector<Segment>& segments);

/// find_residual_noise() of every output (column); none where a column's root mean square is below
/// `rounding` (n_z).
std::vector<std::optional<NoiseModel>> find_output_noise(const Eigen::MatrixXd& residuals,
                                                         const std::vector<Segment>& runs,
                                                         const Eigen::VectorXd& rounding,
                                                         base::ThreadPool& pool);

/// The noise behind a score J' R^-1 r.
struct ScoreNoise {
  const Eigen::VectorXd& deviations;  // n_z, R's
  const std::vector<std::optional<NoiseModel>>& models;
  const std::vector<Segment>& runs;
  double inflation = 1.0;  // of the models' variances, M / (M - n)
};

/// The sandwich's middle in the coordinates of an upper triangle K (k x k): the covariance K^-T
/// [sum_j J_j' Sigma_j J_j / r_jj^2] K^-1 of the score. `tangents`: n_z of [A | D | r]; `columns`:
/// which k of theirs are J's.
Eigen::MatrixXd find_score_covariance(std::vector<Eigen::MatrixXd> tangents,
                                      const ScoreNoise& noise,
                                      const std::vector<Eigen::Index>& columns,
                                      const Eigen::MatrixXd& K, base::ThreadPool& pool);

}  // namespace sepcal::estimation
