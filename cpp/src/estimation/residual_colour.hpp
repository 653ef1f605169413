// SPDX-License-Identifier: BSD-3-Clause
// The colour of residuals: which noise model each output's has, if it is not white, and what that
// makes of the covariance of a score.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "base/thread_pool.hpp"
#include "estimation/summed_rows.hpp"
#include "noise/gauss_markov_noise.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal::estimation {

/// Whether a row tells nothing of the next.
bool is_white(const NoiseModel& noise);

/// The noise of an output's residual `e`, or nothing where there is none to tell: fewer than 30
/// rows, or a residual of zeros. White where nothing else is better by BIC.
std::optional<NoiseModel> find_residual_noise(std::span<const double> e,
                                              const std::vector<Segment>& segments);

/// Noise behind the residual of a fit: of two families, the one of less BIC. It is that of
/// sums of `stride` rows that follow each other in a run, over sqrt(stride): where a residual is
/// held or interpolated, `held` rows count as one; of a long one only slow noise matters. Where the
/// columns that were fitted move with the noise, as those made of a noisy input do, restricted
/// likelihood takes that for very slow noise, and it is the noise of the residual by itself.
struct OutputNoise {
  std::variant<NoiseModel, noise::GaussMarkovNoise> model;
  Eigen::Index stride = 1;
  Eigen::Index held = 1;
  bool moves_with_columns = false;
};

/// Rows after which the noise's autocorrelation is below 1/e (but for the share of it that is
/// white); infinite for a level that is free.
double correlation_rows(const OutputNoise& noise);

bool is_white(const OutputNoise& noise);

/// The noise of an output's residual `e` (rows) by restricted likelihood, X (rows x k) being the
/// columns that were fitted. As find_residual_noise() where the noise's level is free in many runs,
/// each of which would take a column of its own.
std::optional<OutputNoise> find_restricted_noise(const Eigen::VectorXd& e, const Eigen::MatrixXd& X,
                                                 const std::vector<Segment>& runs);

/// The same from the residual by itself: X says no more than how many rows may be summed.
std::optional<OutputNoise> find_noise_by_itself(const Eigen::VectorXd& e, const Eigen::MatrixXd& X,
                                                const std::vector<Segment>& runs);

/// That of every output, `columns` of its tangent [A | D | r] and its column of `residuals`; none
/// where that column's root mean square is below `rounding` (n_z).
std::vector<std::optional<OutputNoise>> find_output_noise(
    const std::vector<Eigen::MatrixXd>& tangents, const std::vector<Eigen::Index>& columns,
    const Eigen::MatrixXd& residuals, const std::vector<Segment>& runs,
    const Eigen::VectorXd& rounding, base::ThreadPool& pool);

/// X' Sigma X / deviation^2.
Eigen::MatrixXd covariance_product(const OutputNoise& noise, double deviation,
                                   const std::vector<Segment>& runs, const Eigen::MatrixXd& X);

/// The noise behind a score J' R^-1 r.
struct ScoreNoise {
  const Eigen::VectorXd& deviations;  // n_z, R's
  const std::vector<std::optional<OutputNoise>>& models;
  const std::vector<Segment>& runs;
};

/// The sandwich's middle in the coordinates of an upper triangle K (k x k): the covariance K^-T
/// [sum_j J_j' Sigma_j J_j / r_jj^2] K^-1 of the score. `tangents`: n_z of [A | D | r]; `columns`:
/// which k of theirs are J's.
Eigen::MatrixXd find_score_covariance(std::vector<Eigen::MatrixXd> tangents,
                                      const ScoreNoise& noise,
                                      const std::vector<Eigen::Index>& columns,
                                      const Eigen::MatrixXd& K, base::ThreadPool& pool);

}  // namespace sepcal::estimation
