// SPDX-License-Identifier: BSD-3-Clause
// A hypothesis: the residual is a combination of some columns plus noise, each output's with a
// model of its own, all estimated together by maximum likelihood. Two nested ones give the
// likelihood ratio of what the larger has more.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/linearisation.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal {

using NoiseModels = std::vector<NoiseModel>;  // of each used output, in units of its RMSE

struct Hypothesis {
  NoiseModels noise = {};
  double minus_two_log_likelihood = 0.0;
  Eigen::VectorXd coefficients = {};  // of the columns
  Eigen::MatrixXd covariance = {};    // of the coefficients, in that noise
};

/// The noise models of a residual (count() rows), of free order.
NoiseModels fit_noise_models(const RowLayout& layout, const Eigen::VectorXd& residual);

/// White models of the same order and freedom of the level: another start of the search.
NoiseModels forget_colour(NoiseModels noise);

/// Whitens columns of count() rows, output by output.
void whiten(const RowLayout& layout, const NoiseModels& noise, Eigen::MatrixXd& columns);

/// How well a likelihood is maximised.
struct Effort {
  int rounds = 3;            // of generalised least squares and the noise model by turns
  double least_gain = 1e-4;  // in -2 ln L, of the search for the noise model
};

/// The best that `starts` lead to; their orders are kept. `columns` are about orthonormal.
Hypothesis maximise(const RowLayout& layout, const Eigen::MatrixXd& columns,
                    const Eigen::VectorXd& residual, const std::vector<NoiseModels>& starts,
                    const Effort& effort = {});

}  // namespace sepcal
