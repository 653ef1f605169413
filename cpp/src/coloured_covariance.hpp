// SPDX-License-Identifier: BSD-3-Clause
// Covariance of estimates whose residuals need not be white. With weights 1 / r_jj and noise of the
// covariance Sigma_j on output j, least squares varies by
//   H^-1 [sum_j J_j' Sigma_j J_j / r_jj^2] H^-1,   H = sum_j J_j' J_j / r_jj,
// Sigma_j from the noise model of the output's own residual (the sandwich of Huber and White).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "sepcal/noise_model.hpp"
#include "stages.hpp"
#include "sweep.hpp"

namespace sepcal {

/// The noise of an output's residual `e`, or nothing where there is none to tell: fewer than 30
/// rows, or a residual of zeros. White where nothing else is better by BIC.
std::optional<NoiseModel> find_residual_noise(std::span<const double> e,
                                              const std::vector<Segment>& segments);

/// Covariance (k x k) of k parameters at `two`:
///   inside       which of the n free parameters they are
///   R            k x k, upper: R'R = H
///   white        what white noise of standard deviation two.noise gives, R^-1 R^-T or a multiple
///   noise_given  two.noise is the caller's: outputs without a noise model are white with it
/// `white` itself where every output is white at an estimated R, or where J, H or the residuals are
/// not finite. Each Sigma_j is scaled by M / (M - n), the freedom that the fit took from residuals.
Eigen::MatrixXd find_coloured_covariance(const Sweep& sweep, const StageTwo& two,
                                         const std::vector<Eigen::Index>& inside,
                                         const Eigen::MatrixXd& R, const Eigen::MatrixXd& white,
                                         bool noise_given);

}  // namespace sepcal
