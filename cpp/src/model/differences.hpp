// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of a function that can only be called: differences of fourth order.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>

#include "sepcal/detail/block_model.hpp"

namespace sepcal::model {

/// g'(0) of g: R -> R^m, entry by entry, from g at a few multiples of a step:
///   central, g' = [8 (g(h) - g(-h)) - (g(2h) - g(-2h))] / 12h + O(h^4), where [-2h, 2h] lies in
///   [lower, upper]; else one-sided with five points;
///   an entry that is not finite takes a one-sided difference that is.
/// The step h is 2^-11 of `scale`, over which g should bend but little, and smaller where central
/// differences over h and 2h disagree by more than 1e-5 of the largest entry. Entries stay not
/// finite where no side is.
Eigen::VectorXd differentiate(const std::function<Eigen::VectorXd(double)>& g, double scale,
                              double lower, double upper);

/// Fills `columns`, m x inputs.size(), with the derivatives of `predict`: block -> R^m by the
/// chosen inputs of a block, each moved by the same in every row.
void differentiate_by_inputs(const std::function<Eigen::VectorXd(const Block&)>& predict,
                             const Block& block, std::span<const int> inputs,
                             Eigen::Ref<Eigen::MatrixXd> columns);

}  // namespace sepcal::model
