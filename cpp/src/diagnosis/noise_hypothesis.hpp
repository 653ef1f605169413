// SPDX-License-Identifier: BSD-3-Clause
// A hypothesis: the residual is a combination of some columns plus noise, each output's with a
// model of its own, all estimated together by maximum likelihood. Two nested ones give the
// likelihood ratio of what the larger has more.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "diagnosis/columns.hpp"
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

/// [X e]' [X e] of columns X and a residual e once `whiten` has changed each output's; of very many
/// columns a few at a time.
Eigen::MatrixXd white_products(
    const RowLayout& layout, const Columns& X, const Eigen::VectorXd& e,
    const std::function<void(std::size_t j, Eigen::Ref<Eigen::MatrixXd> columns)>& whiten);

/// Of products X'X those of the columns behind the first `known`, beyond the span of these.
Eigen::MatrixXd products_beyond(const Eigen::MatrixXd& products, Eigen::Index known);

/// Of a symmetric matrix that is not negative. A free level of the noise leaves constants
/// undetermined: such directions stay zero.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& square);

/// Steps until they gain nothing, from the best of `starts`, whose orders are kept.
Hypothesis maximise(const RowLayout& layout, const Columns& columns,
                    const Eigen::VectorXd& residual, const std::vector<NoiseModels>& starts);

}  // namespace sepcal::diagnosis
