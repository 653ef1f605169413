// SPDX-License-Identifier: BSD-3-Clause
// Where a noise fit starts: the order p and d of least AIC, of a stationary level and of a free
// one. For each d the rows (their differences where the level is free) are whitened as for p = 0,
// and Burg's lattice fits every order at once to what is left.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "sepcal/noise_model.hpp"

namespace sepcal::noise {

struct NoiseOrder {
  double d = 0.0;
  Eigen::VectorXd partial;  // p partial autocorrelations of phi
};

/// AIC less -2 ln L, corrected for few rows (Hurvich & Tsai), for an order.
double penalise(Eigen::Index order, Eigen::Index rows);

/// `e` has the rows of segments of `lengths` rows, one after another; there are differences in them
/// that are not zero. The stationary start comes first.
std::array<NoiseOrder, 2> choose_noise_orders(const Eigen::VectorXd& e,
                                              const std::vector<Eigen::Index>& lengths,
                                              const NoiseFitOptions& options);

/// By how much -2 ln L falls from white noise to the likeliest d of a scan over stationary levels,
/// for the orders 0, ..., as high as choose_noise_orders() goes.
Eigen::VectorXd scan_gains(const Eigen::VectorXd& e, const std::vector<Eigen::Index>& lengths);

}  // namespace sepcal::noise
