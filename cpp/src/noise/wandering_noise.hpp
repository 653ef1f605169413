// SPDX-License-Identifier: BSD-3-Clause
// White noise beside Gauss & Markov's: e_t = w_t + g_t, g_{t+1} = a g_t + q_t, a = exp(-1 / rows).
// It is what the velocity of a satellite receiver has, and with no white share an AR(1). Its
// parameters are found by restricted likelihood: what a model of p columns X was fitted to the rows
// has taken of the noise does not count,
//   -2 ln L = (N - p) ln(e' P e / (N - p)) + ln det S + ln det X'S^-1 X,   P = S^-1 - S^-1 X
//   (...)^-1
//             X'S^-1,  S the covariance over sigma^2
// (Patterson & Thompson, Biometrika 58, 1971). Without the last term the noise of a short record
// comes out too small where it matters, at the pace of the columns.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/noise_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::noise {

struct WanderingNoise {
  double rows = 1.0;   // correlation time of g
  double white = 1.0;  // share of w in the variance
  double sigma = 1.0;  // standard deviation of e
};

/// X' S X (q x q) of columns X (rows x q, gather_rows' layout), S the covariance of the noise.
Eigen::MatrixXd covariance_product(const WanderingNoise& noise, const std::vector<Segment>& runs,
                                   const Eigen::Ref<const Eigen::MatrixXd>& X);

/// A noise with its restricted -2 ln L, less what does not depend on the noise.
struct WanderingFit {
  WanderingNoise noise;
  double minus_two_log_likelihood = 0.0;
};

/// `columns`: [X | e], X orthonormal, of fewer columns than rows.
WanderingFit fit_wandering(const Eigen::MatrixXd& columns, const std::vector<Segment>& runs);

/// The least -2 ln L on the grid that fit_wandering() starts from.
double scan_wandering(const Eigen::MatrixXd& columns, const std::vector<Segment>& runs);

/// The same as fit_wandering() of white noise.
WanderingFit fit_white_rows(const Eigen::MatrixXd& columns);

/// The restricted -2 ln L of a noise model with a distribution of its own, at its best sigma, which
/// it is given.
double restricted_likelihood(const Eigen::MatrixXd& columns, const std::vector<Segment>& runs,
                             NoiseModel& model);

}  // namespace sepcal::noise
