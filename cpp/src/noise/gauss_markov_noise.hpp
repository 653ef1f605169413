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

#include "sepcal/detail/quantity.hpp"
#include "sepcal/noise_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::noise {

struct GaussMarkovNoise {
  double rows = 1.0;   // correlation time of g
  double white = 1.0;  // share of w in the variance
  double sigma = 1.0;  // standard deviation of e
};

/// X' S X (q x q) of columns X (rows x q, gather_rows' layout), S the covariance of the noise.
Eigen::MatrixXd covariance_product(const GaussMarkovNoise& noise, const std::vector<Segment>& runs,
                                   const Eigen::Ref<const Eigen::MatrixXd>& X);

/// The restricted -2 ln L of a noise at its best sigma, less what does not depend on the noise.
struct Restricted {
  double minus_two_log_likelihood = infinity;
  double sigma = 0.0;
  Eigen::MatrixXd gram = {};  // the products of [X | e], whitened but for sigma
};

/// How much more of e the columns X explain by generalised least squares than the noise allows,
/// where e is what ordinary least squares left: no more than 1 on average, `covariance` being X' S
/// X of sigma 1. Far more is noise that moves with the columns, as that of a logged input does.
double excess_explained(const Restricted& restricted, const Eigen::MatrixXd& covariance,
                        Eigen::Index rows);

struct GaussMarkovFit {
  GaussMarkovNoise noise;
  Restricted restricted;
};

/// `columns`: [X | e], X orthonormal, of fewer columns than rows.
GaussMarkovFit fit_gauss_markov(const Eigen::MatrixXd& columns, const std::vector<Segment>& runs);

/// The least -2 ln L on the grid that fit_gauss_markov() starts from.
double scan_gauss_markov(const Eigen::MatrixXd& columns, const std::vector<Segment>& runs);

/// The same as fit_gauss_markov() of white noise.
GaussMarkovFit fit_white_rows(const Eigen::MatrixXd& columns);

/// That of a noise model with a distribution of its own, which is given its best sigma.
Restricted restricted_likelihood(const Eigen::MatrixXd& columns, const std::vector<Segment>& runs,
                                 NoiseModel& model);

}  // namespace sepcal::noise
