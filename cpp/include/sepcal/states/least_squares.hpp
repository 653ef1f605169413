// SPDX-License-Identifier: BSD-3-Clause
// Weighted and iterated least squares over samples, S 4.1 to 4.8, in fixed size: y(k) = f(k, p) +
// e(k) with W(k) = E(e e'). A few parameters in flight; fits of whole records are sepcal/fit.hpp.
#pragma once

#include <cmath>

#include "sepcal/detail/states/information_root.hpp"
#include "sepcal/detail/states/triangle.hpp"

namespace sepcal {

/// A sample about p: z = y - f(k, p) (NaN where missing), H = df/dp (S 4.2 calls one matrix h and
/// H).
template <int M, int N, class Scalar = double>
struct LeastSquaresRows {
  Eigen::Vector<Scalar, M> z;
  Eigen::Matrix<Scalar, M, N> H;
  Eigen::Matrix<Scalar, M, M> W;  // covariance of e: its inverse weighs (S 4.5)
};

enum class LeastSquaresStatus {
  converged,
  not_converged,   // iterations ended by their cap, or no step made the cost fall
  not_determined,  // the rows leave a parameter open
  refused,         // a number that is not finite, or a W that is not positive definite
};

template <int N, class Scalar = double>
struct LeastSquares {
  LeastSquaresStatus status = LeastSquaresStatus::refused;
  int iterations = 0;
  Eigen::Vector<Scalar, N> p;  // S 4.8
  InformationRoot<N, Scalar> rows =
      {};           // about p: rows.covariance() is S 4.7, rows.matrix() starts a stream
  Scalar cost = 0;  // V(p), S 4.5
};

struct LeastSquaresOptions {
  int iterations = 50;      // at most
  double tolerance = 1e-8;  // |R dp| <= tolerance: a step, in standard deviations of p
  int halvings = 30;        // of a step that makes the cost rise; S 4.8 takes the whole
};

namespace states {

/// All samples about p, as [R q; 0 rho] of W^-1/2 [H z]; false where one is unfit.
template <int N, class Scalar, class Sample>
bool gather(const Sample& sample, int count, const Eigen::Vector<Scalar, N>& p,
            InformationRoot<N, Scalar>& rows) {
  using Root = InformationRoot<N, Scalar>;
  rows = Root(Root::Triangle::Zero(p.size() + 1, p.size() + 1));
  for (int k = 0; k < count; ++k) {
    const auto at = sample(k, p);
    if (!rows.absorb(at.H, at.z, at.W)) return false;
  }
  return true;
}

/// V(p) of the rows about p, S 4.5: at dp = 0, where rows.cost() is that of their solution.
template <int N, class Scalar>
Scalar cost_about(const InformationRoot<N, Scalar>& rows) {
  return Scalar(0.5) * rows.matrix().template rightCols<1>().squaredNorm();
}

}  // namespace states

/// Gauss and Newton from p (S 4.6 and 4.8), `sample(k, p)` giving LeastSquaresRows<M, N> of sample
/// k = 0 ... count - 1. A linear f takes one step, and a second to see it.
template <int N, class Scalar, class Sample>
LeastSquares<N, Scalar> iterate_least_squares(const Sample& sample, int count,
                                              Eigen::Vector<Scalar, N> p,
                                              const LeastSquaresOptions& options = {}) {
  using enum LeastSquaresStatus;
  constexpr Scalar slack =
      4096 * states::rounding<Scalar>;  // two costs differ by rounding before their steps do
  LeastSquares<N, Scalar> fit{.p = p};
  if (!states::gather(sample, count, fit.p, fit.rows)) return fit;
  fit.cost = states::cost_about(fit.rows);
  fit.status = not_converged;
  for (fit.iterations = 0; fit.iterations < options.iterations; ++fit.iterations) {
    if (!fit.rows.determined()) {
      fit.status = not_determined;
      return fit;
    }
    Eigen::Vector<Scalar, N> step = fit.rows.solution();
    // What rounds in the step, of the rows' size and of p's, is not asked for.
    const Scalar rounds = 8 * states::rounding<Scalar> *
                          (fit.rows.matrix().template rightCols<1>().norm() +
                           states::product(fit.rows.root(), fit.p).norm());
    const bool last = fit.rows.matrix().template topRightCorner<N, 1>(p.size(), 1).norm() <=
                      static_cast<Scalar>(options.tolerance) + rounds;
    InformationRoot<N, Scalar> rows;
    const Scalar most = fit.cost * (1 + slack);
    bool lower = false;
    for (int half = 0; half <= options.halvings && !lower; ++half, step *= Scalar(0.5)) {
      p = fit.p + step;
      lower = states::gather(sample, count, p, rows) && rows.count() == fit.rows.count() &&
              (last || states::cost_about(rows) <= most);
    }
    if (!lower) return fit;
    fit = {fit.status, fit.iterations, p, rows, states::cost_about(rows)};
    if (last) {
      fit.status = converged;
      return fit;
    }
  }
  return fit;
}

}  // namespace sepcal
