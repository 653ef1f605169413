// SPDX-License-Identifier: BSD-3-Clause
// What the process noise of a state model adds to the covariance from a row to the next.
#pragma once

#include "sepcal/detail/states/autodiff.hpp"
#include "sepcal/detail/states/integration.hpp"
#include "sepcal/detail/states/product.hpp"
#include "sepcal/states/discretise.hpp"
#include "sepcal/states/state_model.hpp"

namespace sepcal {

/// Q_d (n_x x n_x) of a step, Van Loan's with F and G at x, a state half-way. Q (n_w x n_w): the
/// density of the model's noise, (unit of the table)^2; of a model in discrete time its covariance.
template <StateModel M, class Scalar>
Eigen::Matrix<Scalar, StateSizes<M>::n_x, StateSizes<M>::n_x> noise_of_step(
    const M& model, const Between<M, Scalar>& between, const Vec<Scalar, StateSizes<M>::n_x>& x,
    const Vec<Scalar, StateSizes<M>::n_p>& p,
    const Eigen::Matrix<Scalar, StateSizes<M>::n_w, StateSizes<M>::n_w>& Q) {
  constexpr int n_x = StateSizes<M>::n_x;
  const Vec<Scalar, StateSizes<M>::n_u> u = between.u(Scalar(is_discrete<M>() ? 0.0 : 0.5));
  const Eigen::Matrix<Scalar, n_x, StateSizes<M>::n_w> G = noise_input<M, Scalar>(model, x, u, p);
  const Eigen::Matrix<Scalar, n_x, n_x> density = states::product(G, Q, G.transpose());
  if constexpr (is_discrete<M>()) {
    return density;
  } else {
    const auto rate = [&]<class T>(const Vec<T, n_x>& at) -> Vec<T, n_x> {
      return model.rate(at, u, Vec<T, StateSizes<M>::n_p>(p.template cast<T>()));
    };
    return discretise<n_x, Scalar>(differentiate(rate, x).jacobian, density, between.duration())
        .Q_d;
  }
}

}  // namespace sepcal
