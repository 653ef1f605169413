// SPDX-License-Identifier: BSD-3-Clause
// The extended Kalman filter's prediction, S 3.1 to 3.11: a continuous nonlinear system over a step
// of time becomes a Transition, with which a Filter predicts.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "sepcal/detail/states/linearisation.hpp"
#include "sepcal/states/discretise.hpp"

namespace sepcal {

/// x' = f(x, t) + G(x, t) w, S 3.1. Inputs u(t) are the system's own business: it holds those of
/// the step, held or linear in time.
///   rate(x, t)            f, n_x
///   rate_jacobian(x, t)   F_x = df/dx, n_x x n_x, S 3.6; autodiff.hpp makes it from a template
///   noise_input(x, t)     G, n_x x n_w
template <class S, int NX, int NW, class Scalar = double>
concept ContinuousSystem = requires(const S& system, const Eigen::Vector<Scalar, NX>& x, Scalar t,
                                    Eigen::Vector<Scalar, NX> f, Eigen::Matrix<Scalar, NX, NX> F,
                                    Eigen::Matrix<Scalar, NX, NW> G) {
  f = system.rate(x, t);
  F = system.rate_jacobian(x, t);
  G = system.noise_input(x, t);
};

namespace states {

/// One step of Runge and Kutta's fourth order, and the state half-way.
template <int NX, class Scalar>
struct RungeKutta {
  Eigen::Vector<Scalar, NX> middle;
  Eigen::Vector<Scalar, NX> end;
};

template <int NX, class Scalar, class System>
RungeKutta<NX, Scalar> runge_kutta(const System& system, const Eigen::Vector<Scalar, NX>& x,
                                   std::type_identity_t<Scalar> t,
                                   std::type_identity_t<Scalar> dt) {
  using Vector = Eigen::Vector<Scalar, NX>;
  const Scalar half = Scalar(0.5) * dt;
  const Vector k1 = system.rate(x, t);
  const Vector k2 = system.rate(Vector(x + half * k1), t + half);
  const Vector middle = x + half * k2;
  const Vector k3 = system.rate(middle, t + half);
  const Vector k4 = system.rate(Vector(x + dt * k3), t + dt);
  return {middle, x + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)};
}

}  // namespace states

/// From x at `begin` to `end` (s), in steps of at most `longest_step` (s): x by Runge and Kutta
/// (3.10); Phi (3.9) and Q_d (3.11) by discretise() at the nominal state half-way, which is an
/// order better than at the step's begin. Q is the density of w, unit^2 s (n_w x n_w). The noise is
/// one of the states: Gamma = I. What is not finite makes the transition so, and the filter refuses
/// it.
template <int NX, int NW, class Scalar, class System>
  requires ContinuousSystem<System, NX, NW, Scalar>
Transition<NX, NX, Scalar> propagate(
    const System& system, const Eigen::Vector<Scalar, NX>& x,
    const Eigen::Matrix<Scalar, NW, NW>& Q, std::type_identity_t<Scalar> begin,
    std::type_identity_t<Scalar> end,
    std::type_identity_t<Scalar> longest_step = std::numeric_limits<Scalar>::infinity()) {
  using Matrix = Eigen::Matrix<Scalar, NX, NX>;
  constexpr Scalar most_steps = 1e6;  // no loop without end for a longest_step of zero
  const Scalar steps = std::max(Scalar(1), std::ceil((end - begin) / longest_step));
  const Scalar dt = (end - begin) / steps;
  const Eigen::Index n = x.size();
  Transition<NX, NX, Scalar> whole{x, Matrix::Identity(n, n), Matrix::Identity(n, n),
                                   Matrix::Zero(n, n)};
  const bool endless = !(steps <= most_steps);
  if (endless) whole.x.setConstant(std::numeric_limits<Scalar>::quiet_NaN());
  const int count = endless ? 0 : static_cast<int>(steps);
  for (int k = 0; k < count && whole.x.allFinite(); ++k) {
    const Scalar t = begin + static_cast<Scalar>(k) * dt;
    const states::RungeKutta<NX, Scalar> step = states::runge_kutta(system, whole.x, t, dt);
    const Matrix F = system.rate_jacobian(step.middle, t + Scalar(0.5) * dt);
    const Eigen::Matrix<Scalar, NX, NW> G = system.noise_input(step.middle, t + Scalar(0.5) * dt);
    const Matrix density = states::product(G, Q, G.transpose());
    const DiscreteNoise<NX, Scalar> part = discretise<NX, Scalar>(F, density, dt);
    whole.Phi = states::product(part.Phi, whole.Phi);
    whole.Q_d = states::product(part.Phi, whole.Q_d, part.Phi.transpose()) + part.Q_d;
    whole.x = step.end;
  }
  return whole;
}

}  // namespace sepcal
