// SPDX-License-Identifier: BSD-3-Clause
// A stationary AR(p) by its partial autocorrelations, each within (-1, 1) (Durbin & Levinson).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/record.hpp"

namespace sepcal::noise {

/// phi (p) of partial autocorrelations (p).
Eigen::VectorXd phi_from_partial(const Eigen::VectorXd& partial);

/// The inverse. Where phi is not stationary some |partial| is 1 or more, or not a number.
Eigen::VectorXd partial_from_phi(Eigen::VectorXd phi);

/// Whether it is, as far as its partial autocorrelations can be told after rounding.
bool is_stationary(const Eigen::VectorXd& phi);

/// Every row past the first p loses what phi (p) predicts of it from those before.
void subtract_predictions(const Eigen::VectorXd& phi, Eigen::Ref<Eigen::VectorXd> x);

/// -2 ln L less its constant, profiled over sigma, of AR(0), ..., AR(max_order) by Burg's lattice
/// over blocks of rows; the rows of `y` are those of the blocks, one after another.
struct BurgFit {
  Eigen::VectorXd criterion;  // max_order + 1: N ln(square / N) + log_ratio
  Eigen::VectorXd log_ratio;  // max_order + 1: of the first rows' variances, less
  Eigen::VectorXd partial;    // max_order; the first p of them are those of AR(p)
};
BurgFit fit_burg(const Eigen::VectorXd& y, const std::vector<Eigen::Index>& lengths, int max_order);

}  // namespace sepcal::noise
