// SPDX-License-Identifier: BSD-3-Clause
// A small Levenberg-Marquardt refinement within bounds, for flight: it says at which p it wants the
// samples' rows and is told them one by one, so that a pass over them may be spread over as many
// calls as there is time for. Nothing is squared: a trial step is a triangular factor with a few
// rows more. K. Madsen, H. Nielsen & O. Tingleff, Methods for Non-Linear Least Squares Problems
// (2004), Sec. 3.2.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>

#include "sepcal/detail/states/information_root.hpp"
#include "sepcal/detail/states/triangle.hpp"
#include "sepcal/states/least_squares.hpp"

namespace sepcal {

struct RefinementOptions {
  int iterations = 50;  // trial steps, at most
  /// |R dp| <= tolerance: the step that is left to what no bound holds, in standard deviations of
  /// p.
  double tolerance = 1e-10;
  double damping = 1e-3;  // of the first step, beside the columns' own sizes
};

/// Of N parameters: while step() answers true, absorb() takes all samples' rows at trial(), and
/// then step() decides on them. What it takes is bounded by N alone.
template <int N, class Scalar = double>
class LevenbergMarquardt {
 public:
  using Vector = Eigen::Vector<Scalar, N>;
  using Root = InformationRoot<N, Scalar>;

  /// From p, brought within its bounds, which may be infinite, or the same. A p that is not finite
  /// and bounds that cross are refused by the first step().
  LevenbergMarquardt(const Vector& p, const Vector& lower, const Vector& upper,
                     const RefinementOptions& options = {})
      : options_(options),
        lower_(lower),
        upper_(upper),
        p_(p.cwiseMax(lower).cwiseMin(upper)),
        trial_(p_),
        damping_(static_cast<Scalar>(options.damping)),
        sound_(p.allFinite() && (lower.array() <= upper.array()).all()) {}

  /// Where rows are wanted.
  const Vector& trial() const { return trial_; }

  /// A sample's z = y - f(p) and H = df/dp at trial(), and the covariance W of its errors; NaN in z
  /// where missing, at every p alike. What is not finite makes the trial one that is not taken.
  template <int M>
  void absorb(const LeastSquaresRows<M, N, Scalar>& rows) {
    sound_ = rows_.absorb(rows.H, rows.z, rows.W) && sound_;
  }

  /// Whether rows are wanted at the next trial(); else status() says how it ended.
  bool step() {
    const Scalar cost = cost_of(rows_);
    const bool sound = sound_ && std::isfinite(cost);
    if (!begun_) {
      if (!sound) return false;  // refused
      begun_ = true;
      take();
    } else {
      ++iterations_;
      // A model that is no number in a row must not pass for one of which that row is missing.
      const bool lower = sound && rows_.count() == taken_.count() && cost <= cost_ * (1 + slack);
      adapt(lower && predicted_ > 0 ? (cost_ - cost) / predicted_ : Scalar(-1));
      if (lower) take();
      if (!lower && is_flat()) damping_ = infinite;  // no step is seen any more to gain anything
    }
    rows_ = Root();
    sound_ = true;
    const bool goes_on =
        !is_still() && iterations_ < options_.iterations && damping_ < most_damping;
    if (goes_on) {
      propose();
    } else {
      status_ = ended();
    }
    return goes_on;
  }

  LeastSquaresStatus status() const { return status_; }
  const Vector& p() const { return p_; }
  const Root& rows() const { return taken_; }  // about p()
  Scalar cost() const { return cost_; }        // V(p), S 4.5
  int iterations() const { return iterations_; }
  /// Whether p stands at a bound k that holds it against its gradient.
  bool held(int k) const { return held_[k]; }

  /// Whether the rows tell every parameter that is not held from the others: of its column's length
  /// more than a millionth, in float a ten-thousandth, is its own.
  bool determined() const {
    const Triangle R = free_triangle();
    for (int k = 0; k < N; ++k) {
      const Scalar length = R.col(k).norm();
      if (!held_[k] && !(std::abs(R(k, k)) > own_share * length)) return false;
    }
    return true;
  }

 private:
  using Square = Eigen::Matrix<Scalar, N, N>;
  using Triangle = Root::Triangle;
  using Flags = Eigen::Array<bool, N, 1>;

  static constexpr Scalar infinite = std::numeric_limits<Scalar>::infinity();
  static constexpr Scalar digits_lost = 8 * states::rounding<Scalar>;
  static constexpr Scalar slack = 64 * states::rounding<Scalar>;
  static constexpr auto most_damping = static_cast<Scalar>(1e12);
  static constexpr Scalar own_share = std::same_as<Scalar, float> ? Scalar(1e-4) : Scalar(1e-6);

  /// V at the point itself: InformationRoot::cost() is that of its solution.
  static Scalar cost_of(const Root& rows) {
    return Scalar(0.5) * rows.matrix().col(N).squaredNorm();
  }

  /// The trial becomes p: what its bounds hold there, and the step that is left to the others.
  void take() {
    taken_ = rows_;
    p_ = trial_;
    cost_ = cost_of(taken_);
    const Triangle& T = taken_.matrix();
    const Square R = T.template topLeftCorner<N, N>();
    const Vector q = T.col(N).template head<N>();
    const Vector gradient = states::product(R.transpose(), q);
    for (int k = 0; k < N; ++k) {
      held_[k] = lower_[k] == upper_[k] || (p_[k] <= lower_[k] && gradient[k] < 0) ||
                 (p_[k] >= upper_[k] && gradient[k] > 0);
    }
    left_ = free_triangle().col(N).template head<N>().norm();
    rounds_ = digits_lost * (T.col(N).norm() + states::product(R, p_).norm());
  }

  /// Nothing is left of the step but what rounds in it.
  bool is_still() const { return left_ <= static_cast<Scalar>(options_.tolerance) + rounds_; }
  /// What the step that is left could gain is what rounds in the cost.
  bool is_flat() const { return Scalar(0.5) * left_ * left_ <= slack * cost_; }

  LeastSquaresStatus ended() const {
    if (!determined()) return LeastSquaresStatus::not_determined;
    return is_still() || is_flat() ? LeastSquaresStatus::converged
                                   : LeastSquaresStatus::not_converged;
  }

  /// Nielsen's rule: the less the gain is what was predicted, the shorter the next step.
  void adapt(Scalar gain) {
    if (gain > 0) {
      const Scalar off = 2 * gain - 1;
      damping_ *= std::max(Scalar(1) / 3, 1 - off * off * off);
      growth_ = 2;
    } else {
      damping_ *= growth_;
      growth_ *= 2;
    }
  }

  /// [R q; 0 rho] of the parameters that no bound holds; columns of the others are zero.
  Triangle free_triangle() const {
    Triangle T = taken_.matrix();
    for (int k = 0; k < N; ++k) {
      if (held_[k]) T.col(k).setZero();
    }
    Triangle sorted = Triangle::Zero();
    states::absorb_rows(sorted, T);
    return sorted;
  }

  /// The damped step within the bounds: a parameter that would leave them goes as far as they are,
  /// and the others are solved for again; at most N times.
  void propose() {
    Flags fixed = held_;
    Vector step = Vector::Zero();
    for (int pass = 0; pass <= N; ++pass) {
      const Vector solved = solve_damped(step, fixed);
      bool inside = true;
      for (int k = 0; k < N; ++k) {
        if (fixed[k]) continue;
        step[k] = std::clamp(solved[k], lower_[k] - p_[k], upper_[k] - p_[k]);
        fixed[k] = !(solved[k] == step[k]);
        inside = inside && !fixed[k];
      }
      if (inside) break;
    }
    try_step(step);
    if (!(predicted_ > 0)) step_along_gradient();
  }

  /// The trial, at a bound where the step ends at one, and what the rows promise of it.
  void try_step(const Vector& step) {
    for (int k = 0; k < N; ++k) {
      trial_[k] = step[k] <= lower_[k] - p_[k] ? lower_[k]
                  : step[k] >= upper_[k] - p_[k]
                      ? upper_[k]
                      : std::clamp(p_[k] + step[k], lower_[k], upper_[k]);
    }
    const Triangle& T = taken_.matrix();
    const Vector q = T.col(N).template head<N>();
    const Vector moved = states::product(T.template topLeftCorner<N, N>(), step);
    predicted_ = Scalar(0.5) * (q.squaredNorm() - (q - moved).squaredNorm());
  }

  /// Where parameters held each other back at their bounds: down the gradient of those that are
  /// free, as far as the bounds are, and no farther than the cost is seen to fall.
  void step_along_gradient() {
    const Square R = taken_.matrix().template topLeftCorner<N, N>();
    const Vector q = taken_.matrix().col(N).template head<N>();
    Vector step = states::product(R.transpose(), q);
    for (int k = 0; k < N; ++k) {
      const Scalar size = R.col(k).squaredNorm();
      step[k] = held_[k] || !(size > 0) ? Scalar(0) : step[k] / size;
    }
    const Vector along = states::product(R, step);
    const Scalar square = along.squaredNorm();
    if (square > 0) step *= along.dot(q) / square;
    for (int k = 0; k < N; ++k) step[k] = std::clamp(step[k], lower_[k] - p_[k], upper_[k] - p_[k]);
    try_step(step);
  }

  /// The step of the parameters that are not fixed, beside the steps of those that are.
  Vector solve_damped(const Vector& step, const Flags& fixed) const {
    Triangle rows = taken_.matrix();
    Eigen::Matrix<Scalar, N, N + 1> damping = Eigen::Matrix<Scalar, N, N + 1>::Zero();
    for (int k = 0; k < N; ++k) {
      damping(k, k) = fixed[k] ? Scalar(1) : std::sqrt(damping_) * rows.col(k).norm();
      if (!fixed[k]) continue;
      rows.col(N) -= step[k] * rows.col(k);
      rows.col(k).setZero();
    }
    Triangle damped = Triangle::Zero();
    states::absorb_rows(damped, rows);
    states::absorb_rows(damped, damping);
    return states::solve_upper(Square(damped.template topLeftCorner<N, N>()),
                               damped.col(N).template head<N>());
  }

  RefinementOptions options_;
  Vector lower_;
  Vector upper_;
  Vector p_;
  Vector trial_;
  Root rows_ = {};   // at trial_
  Root taken_ = {};  // at p_
  Flags held_ = Flags::Constant(false);
  Scalar cost_ = infinite;
  Scalar predicted_ = 0;
  Scalar left_ = infinite;  // |R dp| of the step that is left
  Scalar rounds_ = 0;       // of it
  Scalar damping_;
  Scalar growth_ = 2;
  int iterations_ = 0;
  bool sound_;
  bool begun_ = false;
  LeastSquaresStatus status_ = LeastSquaresStatus::refused;
};

/// The whole refinement in one go, `sample(k, p)` giving LeastSquaresRows<M, N> of sample k = 0 ...
/// count - 1: at most count * (options.iterations + 1) samples.
template <int N, class Scalar, class Sample>
LevenbergMarquardt<N, Scalar> refine(const Sample& sample, int count,
                                     const Eigen::Vector<Scalar, N>& p,
                                     const Eigen::Vector<Scalar, N>& lower,
                                     const Eigen::Vector<Scalar, N>& upper,
                                     const RefinementOptions& options = {}) {
  LevenbergMarquardt<N, Scalar> refinement(p, lower, upper, options);
  do {
    for (int k = 0; k < count; ++k) refinement.absorb(sample(k, refinement.trial()));
  } while (refinement.step());
  return refinement;
}

}  // namespace sepcal
