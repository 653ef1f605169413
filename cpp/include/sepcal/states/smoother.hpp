// SPDX-License-Identifier: BSD-3-Clause
// Smoothing, S 2.14 to 2.23: states and noise at k, given measurements after k as well. The pass of
// a filter is stored by whoever runs it, one Stage a sample; nothing here asks for memory.
#pragma once

#include <cstddef>
#include <iterator>
#include <ranges>

#include "sepcal/detail/states/estimate.hpp"
#include "sepcal/detail/states/linearisation.hpp"
#include "sepcal/detail/states/measured.hpp"
#include "sepcal/detail/states/product.hpp"
#include "sepcal/detail/states/triangle.hpp"

namespace sepcal {

/// What smoothing needs of sample k: a filter's estimate() after its update, and what it was
/// predicted with from there to k + 1. Of the last sample `next` may be left as it is.
template <int NX, int NW = NX, class Scalar = double>
struct Stage {
  Estimate<NX, Scalar> filtered;  // x(k|k), P(k|k)
  Transition<NX, NW, Scalar> next{states::zeros<Eigen::Vector<Scalar, NX>>(),
                                  states::zeros<Eigen::Matrix<Scalar, NX, NX>>(),
                                  states::zeros<Eigen::Matrix<Scalar, NX, NW>>(),
                                  states::zeros<Eigen::Matrix<Scalar, NW, NW>>()};
};

/// State and noise at sample k, given all samples: w and Q say when a model fails.
template <int NX, int NW = NX, class Scalar = double>
struct Smoothed {
  Eigen::Vector<Scalar, NX> x;      // x(k|N)
  Eigen::Matrix<Scalar, NX, NX> P;  // P(k|N)
  Eigen::Vector<Scalar, NW> w;      // w_d(k|N), between k and k + 1
  Eigen::Matrix<Scalar, NW, NW> Q;  // Q(k|N)
};

/// What sample k + 1 says of x and w at k: C_k and B_k of S 2.20 and 2.21, and what it leaves open.
template <int NX, int NW = NX, class Scalar = double>
struct SmootherGain {
  static constexpr int N = states::together(NX, NW);
  Eigen::Matrix<Scalar, NX, N> transposed;  // [C_k' B_k']
  Eigen::Matrix<Scalar, N, N> W;            // W'W: covariance of (x, w) given x(k+1)

  /// Of (x, w) at k, for a shift of x(k+1) from what was predicted.
  Eigen::Vector<Scalar, N> shift(const Eigen::Vector<Scalar, NX>& ahead) const {
    return states::product(transposed.transpose(), ahead);
  }
};

/// The array [U_P Phi' U_P 0; U_Q Gamma' 0 U_Q] = Q [U+ V; 0 W] holds all of it: U+ is the root of
/// P(k+1|k), [C_k' B_k'] = U+^-1 V. What a singular P(k+1|k) (a state without noise) does not see
/// is not corrected, as it must be.
template <int NX, int NW, class Scalar>
SmootherGain<NX, NW, Scalar> smoother_gain(const Stage<NX, NW, Scalar>& stage) {
  constexpr int N = SmootherGain<NX, NW, Scalar>::N;
  constexpr int all = states::together(NX, N);
  using Array = Eigen::Matrix<Scalar, all, all>;
  const Eigen::Index n_x = stage.next.Phi.rows();
  const Eigen::Index n_w = stage.next.Q_d.rows();
  const Eigen::Index n = n_x + n_w;
  const Eigen::Matrix<Scalar, NX, NX>& U_P = stage.filtered.root;
  const Eigen::Matrix<Scalar, NW, NW> U_Q = states::upper_root(stage.next.Q_d);
  Eigen::Matrix<Scalar, N, all> rows(n, n_x + n);
  rows << states::product(U_P, stage.next.Phi.transpose()), U_P,
      Eigen::Matrix<Scalar, NX, NW>::Zero(n_x, n_w),
      states::product(U_Q, stage.next.Gamma.transpose()),
      Eigen::Matrix<Scalar, NW, NX>::Zero(n_w, n_x), U_Q;
  Array T = Array::Zero(n_x + n, n_x + n);
  states::absorb_rows(T, rows, static_cast<Scalar>(n) * states::rounding<Scalar>);

  const Eigen::Matrix<Scalar, NX, NX> root = T.template topLeftCorner<NX, NX>(n_x, n_x);
  return {states::solve_upper(root, T.template topRightCorner<NX, N>(n_x, n)),
          T.template bottomRightCorner<N, N>(n, n)};
}

/// From k + 1 back to k, S 2.20 to 2.23; with x(1|1) and P(1|1) it is S 2.16 to 2.19, the second
/// form of single-stage smoothing. Signs as in 2.20 and 2.21: 2.16 and 2.17 print a plus. P(k|N) =
/// P(k|k) - C_k (P(k+1|k) - P(k+1|N)) C_k' is a sum of two positive terms, without an inverse.
template <int NX, int NW, class Scalar>
Smoothed<NX, NW, Scalar> smooth_stage(const Stage<NX, NW, Scalar>& stage,
                                      const SmootherGain<NX, NW, Scalar>& gain,
                                      const Eigen::Vector<Scalar, NX>& x_next,
                                      const Eigen::Matrix<Scalar, NX, NX>& P_next) {
  constexpr int N = SmootherGain<NX, NW, Scalar>::N;
  const Eigen::Index n_x = stage.next.Phi.rows();
  const Eigen::Index n_w = stage.next.Q_d.rows();
  const Eigen::Matrix<Scalar, N, N> covariance =
      states::product(gain.W.transpose(), gain.W) +
      states::product(gain.transposed.transpose(), P_next, gain.transposed);
  const Eigen::Vector<Scalar, N> shift = gain.shift(x_next - stage.next.x);
  return {stage.filtered.x + shift.template topRows<NX>(n_x),
          covariance.template topLeftCorner<NX, NX>(n_x, n_x), shift.template bottomRows<NW>(n_w),
          covariance.template bottomRightCorner<NW, NW>(n_w, n_w)};
}
template <int NX, int NW, class Scalar>
Smoothed<NX, NW, Scalar> smooth_stage(const Stage<NX, NW, Scalar>& stage,
                                      const Eigen::Vector<Scalar, NX>& x_next,
                                      const Eigen::Matrix<Scalar, NX, NX>& P_next) {
  return smooth_stage(stage, smoother_gain(stage), x_next, P_next);
}

/// Of the last sample, x(N|N), and w = 0 with Q_d: nothing later was measured.
template <int NX, int NW, class Scalar>
Smoothed<NX, NW, Scalar> smooth_last(const Stage<NX, NW, Scalar>& last) {
  return {last.filtered.x, last.filtered.covariance(),
          Eigen::Vector<Scalar, NW>::Zero(last.next.Q_d.rows()), last.next.Q_d};
}

/// All stages, S 2.20 to 2.23: smoothed[k] for k = N ... 0. `pass` and `smoothed` are arrays,
/// vectors or spans of Stages and of Smoothed, of the same length.
template <std::ranges::contiguous_range Pass, class Result>
void smooth(const Pass& pass, Result&& smoothed) {  // NOLINT(cppcoreguidelines-missing-std-forward)
  const std::size_t length = std::size(pass);
  if (length == 0) return;
  smoothed[length - 1] = smooth_last(pass[length - 1]);
  for (std::size_t k = length - 1; k-- > 0;) {
    smoothed[k] = smooth_stage(pass[k], smoothed[k + 1].x, smoothed[k + 1].P);
  }
}

/// State and noise of single-stage smoothing in its first form.
template <int NX, int NW, class Scalar = double>
struct SmoothedMeans {
  Eigen::Vector<Scalar, NX> x;  // x(0|1)
  Eigen::Vector<Scalar, NW> w;  // w(0|1)
};

/// x(0|1) and w(0|1) by S 2.14 and 2.15, from y(1) (NaN where missing), what is expected of it at
/// x(1|1), and R(1) (positive definite). Right as printed: R^-1 goes with the residual of the
/// *filtered* state; of the predicted one, y - C x(1|0), it would be Lambda^-1. The covariances are
/// those of smooth_stage(), S 2.18 and 2.19. Where P is much larger than R the residual of the
/// filtered state is what rounding left of it: there smooth_stage() keeps its digits.
template <int NX, int NW, int NZ, class Scalar>
SmoothedMeans<NX, NW, Scalar> smooth_by_residual(const Stage<NX, NW, Scalar>& stage,
                                                 const Eigen::Vector<Scalar, NZ>& y,
                                                 const Linearisation<NZ, NX, Scalar>& expected,
                                                 const Eigen::Matrix<Scalar, NZ, NZ>& R) {
  const states::Measured<NZ, NX, Scalar> seen(y, expected.value, expected.jacobian, R);
  const Eigen::Matrix<Scalar, NZ, NZ> U_R = states::upper_root(seen.R);
  const Eigen::Vector<Scalar, NZ> weighted =
      states::solve_upper(U_R, states::solve_transposed(U_R, seen.e));
  const Eigen::Vector<Scalar, NX> slope = states::product(seen.H.transpose(), weighted);
  return {stage.filtered.x +
              states::product(stage.filtered.covariance(), stage.next.Phi.transpose(), slope),
          states::product(stage.next.Q_d, stage.next.Gamma.transpose(), slope)};
}

}  // namespace sepcal
