// SPDX-License-Identifier: BSD-3-Clause
// A linear system over a step of time, x' = F x + B u + G w: transition, noise and inputs, exact.
// C. F. Van Loan, IEEE Trans. Automatic Control 23 (1978) 395.
#pragma once

#include <cmath>
#include <type_traits>

#include "sepcal/detail/states/triangle.hpp"
#include "sepcal/states/matrix_exponential.hpp"

namespace sepcal {

template <int NX, class Scalar = double>
struct DiscreteNoise {
  Eigen::Matrix<Scalar, NX, NX> Phi;  // exp(F dt), S 3.9
  Eigen::Matrix<Scalar, NX, NX> Q_d;  // integral of exp(F s) G Q G' exp(F's) ds over dt; Gamma = I
};

namespace states {

/// Van Loan's block exp([-F density; 0 F'] dt) = [. E12; 0 E22], Phi = E22', Q_d = Phi E12, taken
/// over dt / 2^s only, where its exp(-F dt) is harmless, and doubled s times: Q_d <- Q_d + Phi Q_d
/// Phi', which adds positive terms. `whole`: F dt.
template <int NX, class Scalar>
DiscreteNoise<NX, Scalar> double_up(const Eigen::Matrix<Scalar, NX, NX>& whole,
                                    const Eigen::Matrix<Scalar, NX, NX>& density, Scalar dt) {
  using Matrix = Eigen::Matrix<Scalar, NX, NX>;
  constexpr int both = together(NX, NX);
  using Square = Eigen::Matrix<Scalar, both, both>;
  const Eigen::Index n = whole.rows();
  const int doublings = count_halvings(whole);
  const Scalar size = column_norm(density);  // Q_d is linear in it
  const Scalar unit = size > 0 ? 1 / size : Scalar(1);
  const Scalar part = std::ldexp(Scalar(1), -doublings);
  Square block = Square::Zero(2 * n, 2 * n);
  block.template topLeftCorner<NX, NX>(n, n) = -whole * part;
  block.template bottomRightCorner<NX, NX>(n, n) = whole.transpose() * part;
  block.template topRightCorner<NX, NX>(n, n) = density * unit;
  const Square E = matrix_exponential(block);

  Matrix Phi = E.template bottomRightCorner<NX, NX>(n, n).transpose();
  Matrix Q = product(Phi, E.template topRightCorner<NX, NX>(n, n));
  for (int k = 0; k < doublings; ++k) {
    Q += product(Phi, Q, Phi.transpose());
    Phi = product(Phi, Phi);
  }
  Q = (Scalar(0.5) * dt * part / unit) * (Q + Q.transpose()).eval();
  return {Phi, Q};
}

/// Roots of Q's diagonal, none below its largest by more than rounding tells.
template <int NX, class Scalar>
Eigen::Vector<Scalar, NX> deviations_of(const Eigen::Matrix<Scalar, NX, NX>& Q) {
  const Scalar least = rounding<Scalar> * Q.diagonal().maxCoeff();
  return Q.diagonal().cwiseMax(least).cwiseSqrt();
}

}  // namespace states

/// Phi and Q_d from F (1/s), the density = G Q G' (state^2/s) and dt (s). S 3.7 and 3.11 leave
/// Gamma Q_d Gamma' open: with Q_d = Q they are wrong by a factor of dt. Of F dt balanced: units of
/// states don't count. Where noise reaches states by a long way alone, as a position's by a rate's,
/// rounding beside the largest variance takes theirs below zero: then it is done again in units of
/// their standard deviations, with variances larger by what rounding makes of these. All NaN where
/// an argument is not finite.
template <int NX, class Scalar = double>
DiscreteNoise<NX, Scalar> discretise(
    const Eigen::Matrix<Scalar, NX, NX>& F,
    const std::type_identity_t<Eigen::Matrix<Scalar, NX, NX>>& density,
    std::type_identity_t<Scalar> dt) {
  Eigen::Matrix<Scalar, NX, NX> whole = F * dt;
  Eigen::Vector<Scalar, NX> d = states::balance(whole);
  const auto in_units_of_d = [&] {
    return states::double_up<NX, Scalar>(
        d.cwiseInverse().asDiagonal() * F * dt * d.asDiagonal(),
        d.cwiseInverse().asDiagonal() * density * d.cwiseInverse().asDiagonal(), dt);
  };
  DiscreteNoise<NX, Scalar> step = in_units_of_d();
  if (step.Q_d.allFinite() && !states::upper_root(step.Q_d).allFinite()) {
    const Scalar slack = Scalar(100) * static_cast<Scalar>(F.rows()) * states::rounding<Scalar>;
    d = d.cwiseProduct(states::deviations_of<NX, Scalar>(step.Q_d));
    step = in_units_of_d();
    step.Q_d.diagonal() *= 1 + slack;  // what is known exactly is so within rounding
  }
  return {d.asDiagonal() * step.Phi * d.cwiseInverse().asDiagonal(),
          d.asDiagonal() * step.Q_d * d.asDiagonal()};
}

template <int NX, int NU, class Scalar = double>
struct DiscreteInputs {
  Eigen::Matrix<Scalar, NX, NU> held;   // Psi of S 2.1: x(k+1) = Phi x(k) + held u(k)
  Eigen::Matrix<Scalar, NX, NU> begin;  // linear between samples:
  Eigen::Matrix<Scalar, NX, NU> end;    // x(k+1) = Phi x(k) + begin u(k) + end u(k+1)
};

/// What inputs do over dt (s), from F (1/s) and B: exp([F dt, B dt, 0; 0 0 I; 0 0 0]). Held inputs
/// lag linear ones by half a sample.
template <int NX, int NU, class Scalar = double>
DiscreteInputs<NX, NU, Scalar> discretise_inputs(
    const std::type_identity_t<Eigen::Matrix<Scalar, NX, NX>>& F,
    const std::type_identity_t<Eigen::Matrix<Scalar, NX, NU>>& B, std::type_identity_t<Scalar> dt) {
  constexpr int all = states::together(NX, states::together(NU, NU));
  using Square = Eigen::Matrix<Scalar, all, all>;
  const Eigen::Index n_x = B.rows();
  const Eigen::Index n_u = B.cols();
  Square block = Square::Zero(n_x + 2 * n_u, n_x + 2 * n_u);
  block.template topLeftCorner<NX, NX>(n_x, n_x) = F * dt;
  block.template block<NX, NU>(0, n_x, n_x, n_u) = B * dt;
  block.template block<NU, NU>(n_x, n_x + n_u, n_u, n_u).setIdentity();
  const Square E = matrix_exponential(block);
  const Eigen::Matrix<Scalar, NX, NU> held = E.template block<NX, NU>(0, n_x, n_x, n_u);
  const Eigen::Matrix<Scalar, NX, NU> end = E.template block<NX, NU>(0, n_x + n_u, n_x, n_u);
  return {held, held - end, end};
}

}  // namespace sepcal
