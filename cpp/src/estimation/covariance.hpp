// SPDX-License-Identifier: BSD-3-Clause
// How much the estimates of a fit vary: of white residuals (R'R)^-1, of others the sandwich
//   H^-1 [sum_j J_j' Sigma_j J_j / r_jj^2 + W] H^-1,   H = sum_j J_j' S_j J_j / r_jj + W,
// Sigma_j the covariance of psi(s) over the rows of output j, S_j the slopes of psi (1 without a
// loss, where psi(s) = s), W the prior. Huber & Ronchetti, Robust Statistics,
// Sec. 7.6.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/block_evidence.hpp"
#include "estimation/residual_colour.hpp"
#include "estimation/stage_two.hpp"
#include "model/sweep.hpp"

namespace sepcal::estimation {

/// The rows that the colour of residuals is found from: all, or an excerpt that stands for them.
struct SampledRows {
  const model::Sweep& sweep;
  double rows = 1.0;  // of the record to one of these
};

struct Covariances {
  std::vector<Eigen::Index> inside;  // k free parameters that no bound holds
  Eigen::MatrixXd white;             // k x k, as if residuals were white
  Eigen::MatrixXd noise_model;       // k x k, as each output's residual is coloured
  Eigen::MatrixXd inverse_hessian;   // k x k, H^-1: white where there is no loss
  /// n x n, upper: the rows of all free parameters over the noise that white residuals are judged
  /// to have, and those of the prior.
  Eigen::MatrixXd tangent;
  Eigen::VectorXd judged;           // n_z, that noise
  double freedom = 0.0;             // measurements less the parameters that they paid for
  bool sample_falls_short = false;  // the sampled rows leave open what all rows determine
  /// n_z, or none where nobody asked: behind noise_model.
  std::vector<std::optional<OutputNoise>> noise = {};
  /// What blocks show of that noise; empty where all of it is white, and of too few rows.
  BlockEvidence evidence = {};
};

/// Where R was estimated, variances are M / (M - p) times what R-hat = SSE / N gives: M
/// measurements, p parameters less what their prior paid. `noise_model` is `white` where
/// every output is white at an estimated R, without FitOptions::coloured_errors, and where
/// something is not finite. Of an excerpt it is taken how much more its score varies than that of
/// white noise would, and of all rows how much they determine. A noise model that the blocks of the
/// record refute gives way to that of the residual by itself.
Covariances find_covariances(const Problem& problem, const model::Sweep& sweep,
                             const SampledRows& sampled, const StageTwo& two);

/// (R' R)^-1 by way of R^-1; NaN throughout where R is singular.
Eigen::MatrixXd inverse_of_square(const Eigen::MatrixXd& R);

/// The triangular factor of a selection of columns (k x k).
Eigen::MatrixXd select_columns(const Eigen::MatrixXd& R, const std::vector<Eigen::Index>& columns);

/// How many of the parameters of a covariance were paid for by the prior, each in part:
/// `weights` are its 1 / standard deviation. 0 where there is no covariance.
double prior_share(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& weights);

/// A covariance of some of n parameters among all of them, NaN for the others.
Eigen::MatrixXd spread(const Eigen::MatrixXd& covariance, const std::vector<Eigen::Index>& places,
                       Eigen::Index n);

/// Ones on the diagonal to the last bit, but NaN for what has no variance.
Eigen::MatrixXd correlation_of(const Eigen::MatrixXd& covariance);

}  // namespace sepcal::estimation
