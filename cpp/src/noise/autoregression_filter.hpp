// SPDX-License-Identifier: BSD-3-Clause
// A block of a stationary AR(p) and its innovations, all of one variance, by partial
// autocorrelations (p): the first rows, which have fewer before them, divided by what is larger.
#pragma once

#include <Eigen/Core>

namespace sepcal::noise {

/// x becomes W x, its innovations.
void whiten_autoregression(const Eigen::VectorXd& partial, Eigen::Ref<Eigen::VectorXd> x);

/// x becomes W' x.
void whiten_autoregression_backwards(const Eigen::VectorXd& partial, Eigen::Ref<Eigen::VectorXd> x);

/// w becomes W^-1 w.
void colour_autoregression(const Eigen::VectorXd& partial, Eigen::Ref<Eigen::VectorXd> w);

}  // namespace sepcal::noise
