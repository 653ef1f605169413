// SPDX-License-Identifier: BSD-3-Clause
// What a filter is told of a system at one sample: outputs and transition, linearised about an
// estimate. A linear system's are exact; an extended filter is the same filter with another
// linearisation. Equation numbers (S 2.7) are the System Identification Summary's.
#pragma once

#include "sepcal/detail/states/product.hpp"

namespace sepcal {

/// A function of n_x states at one of them: h(x) and dh/dx.
template <int NZ, int NX, class Scalar = double>
struct Linearisation {
  Eigen::Vector<Scalar, NZ> value;         // n_z
  Eigen::Matrix<Scalar, NZ, NX> jacobian;  // n_z x n_x
};

/// From sample k to k + 1: x(k+1) = f(x(k)) + Gamma w_d, about x(k|k).
template <int NX, int NW = NX, class Scalar = double>
struct Transition {
  Eigen::Vector<Scalar, NX> x;          // x(k+1|k), S 2.7 or 3.10
  Eigen::Matrix<Scalar, NX, NX> Phi;    // df/dx
  Eigen::Matrix<Scalar, NX, NW> Gamma;  // n_x x n_w
  Eigen::Matrix<Scalar, NW, NW> Q_d;    // covariance of w_d; a density's integral, not the density
};

/// S 2.1: x(k+1) = Phi x(k) + Psi u(k) + Gamma w_d(k). Every sample may have its own.
template <int NX, int NW = NX, class Scalar = double>
struct LinearDynamics {
  Eigen::Matrix<Scalar, NX, NX> Phi;
  Eigen::Matrix<Scalar, NX, NW> Gamma;
  Eigen::Matrix<Scalar, NW, NW> Q_d;

  /// From x, with shift = Psi u (n_x). S 2.7.
  Transition<NX, NW, Scalar> from(const Eigen::Vector<Scalar, NX>& x,
                                  const Eigen::Vector<Scalar, NX>& shift) const {
    return {states::product(Phi, x) + shift, Phi, Gamma, Q_d};
  }
};

/// S 1.2 and 2.2: y = C x + D u + v (1.2 prints y-dot; a measurement has no derivative).
template <int NZ, int NX, class Scalar = double>
struct LinearOutputs {
  Eigen::Matrix<Scalar, NZ, NX> C;

  /// At x, with shift = D u (n_z).
  Linearisation<NZ, NX, Scalar> at(const Eigen::Vector<Scalar, NX>& x,
                                   const Eigen::Vector<Scalar, NZ>& shift) const {
    return {states::product(C, x) + shift, C};
  }
};

}  // namespace sepcal
