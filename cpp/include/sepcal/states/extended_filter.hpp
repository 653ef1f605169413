// SPDX-License-Identifier: BSD-3-Clause
// The extended Kalman filter's prediction, S 3.1 to 3.11: a continuous nonlinear system over a step
// of time becomes a Transition, with which a Filter predicts.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "sepcal/states/discretise.hpp"
#include "sepcal/states/linearisation.hpp"

namespace sepcal {

/// x' = f(x, t) + G(x, t) w, S 3.1. Inputs u(t) are the system's own business: it holds those of
/// the step, held or linear in time.
///   rate(x, t)            f, n_x
///   rate_jacobian(x, t)   F_x = df/dx, n_x x n_x, S 3.6; autodiff.hpp makes it from a template
///   rate noise_input(x, t)     G, n_x x n_w
template <class S, int NX, int NW>
concept ContinuousSystem = requires(const S& system, const Eigen::Vector<double, NX>& x, double t,
                                    Eigen::Vector<double, NX> f, Eigen::Matrix<double, NX, NX> F,
                                    Eigen::Matrix<double, NX, NW> G) {
  f = system.rate(x, t);
  F = system.rate_jacobian(x, t);
  G = system.noise_input(x, t);
};

namespace states {

/// One step of Runge and Kutta's fourth order, and the state half-way.
template <int NX>
struct RungeKutta {
  Eigen::Vector<double, NX> middle;
  Eigen::Vector<double, NX> end;
};

template <int NX, class System>
RungeKutta<NX> runge_kutta(const System& system, const Eigen::Vector<double, NX>& x, double t,
                           double dt) {
  using Vector = Eigen::Vector<double, NX>;
  const double half = 0.5 * dt;
  const Vector k1 = system.rate(x, t);
  const Vector k2 = system.rate(Vector(x + half * k1), t + half);
  const Vector middle = x + half * k2;
  const Vector k3 = system.rate(middle, t + half);
  const Vector k4 = system.rate(Vector(x + dt * k3), t + dt);
  return {middle, x + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)};
}

}  // namespace states

/// From x at `begin` to `end` (s), in steps of at most `longest_step` (s): x by Runge and Kutta
/// (3.10); Phi (3.9) and Q_d (3.11) by discretise() at the nominal state half-way, which is an
/// order better than at the step's begin. Q is the density of w, unit^2 s (n_w x n_w). The noise is
/// one of the states: Gamma = I. What is not finite makes the transition so, and the filter refuses
/// it.
template <int NX, int NW, class System>
  requires ContinuousSystem<System, NX, NW>
Transition<NX> propagate(const System& system, const Eigen::Vector<double, NX>& x,
                         const Eigen::Matrix<double, NW, NW>& Q, double begin, double end,
                         double longest_step = std::numeric_limits<double>::infinity()) {
  using Matrix = Eigen::Matrix<double, NX, NX>;
  constexpr double most_steps = 1e6;  // no loop without end for a longest_step of zero
  const double steps = std::max(1.0, std::ceil((end - begin) / longest_step));
  const double dt = (end - begin) / steps;
  Transition<NX> whole{x, Matrix::Identity(), Matrix::Identity(), Matrix::Zero()};
  const bool endless = !(steps <= most_steps);
  if (endless) whole.x.setConstant(std::numeric_limits<double>::quiet_NaN());
  const int count = endless ? 0 : static_cast<int>(steps);
  for (int k = 0; k < count && whole.x.allFinite(); ++k) {
    const double t = begin + k * dt;
    const states::RungeKutta<NX> step = states::runge_kutta(system, whole.x, t, dt);
    const Matrix F = system.rate_jacobian(step.middle, t + 0.5 * dt);
    const Eigen::Matrix<double, NX, NW> G = system.noise_input(step.middle, t + 0.5 * dt);
    const Matrix density = states::product(G, Q, G.transpose());
    const DiscreteNoise<NX> part = discretise<NX>(F, density, dt);
    whole.Phi = states::product(part.Phi, whole.Phi);
    whole.Q_d = states::product(part.Phi, whole.Q_d, part.Phi.transpose()) + part.Q_d;
    whole.x = step.end;
  }
  return whole;
}

}  // namespace sepcal
