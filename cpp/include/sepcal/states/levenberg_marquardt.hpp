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

#include "sepcal/states/information_root.hpp"
#include "sepcal/states/least_squares.hpp"
#include "sepcal/states/triangle.hpp"

namespace sepcal {

struct RefinementOptions {
  int iterations = 50;       // trial steps, at most
  double tolerance = 1e-10;  // |R dp| <= tolerance: a step, in standard deviations of p
  double damping = 1e-3;     // of the first step, beside the columns' own sizes
};

/// Of N parameters: while step() answers true, absorb() takes all samples' rows at trial(), and
/// then step() decides on them. What it takes is bounded by N alone.
template <int N, class Scalar = double>
class LevenbergMarquardt {
 public:
  using Vector = Eigen::Vector<Scalar, N>;
  using Root = InformationRoot<N, Scalar>;

  /// From p (brought within its bounds, which may be infinite).
  LevenbergMarquardt(const Vector& p, const Vector& lower, const Vector& upper,
                     const RefinementOptions& options = {})
      : options_(options),
        lower_(lower),
        upper_(upper),
        p_(p.cwiseMax(lower).cwiseMin(upper)),
        trial_(p_),
        damping_(static_cast<Scalar>(options.damping)) {}

  /// Where rows are wanted.
  const Vector& trial() const { return trial_; }

  /// A sample's z = y - f(p) and H = df/dp at trial(), and the covariance W of its errors. What is
  /// not finite makes the trial one that is not taken.
  template <int M>
  void absorb(const LeastSquaresRows<M, N, Scalar>& rows) {
    sound_ = rows_.absorb(rows.H, rows.z, rows.W) && sound_;
  }

  /// Whether rows are wanted at the next trial(); else status() says how it ended.
  bool step() {
    using enum LeastSquaresStatus;
    const bool first = !std::isfinite(cost_);
    // A model that is no number in a row must not pass for one of which that row is missing.
    sound_ = sound_ && (first || rows_.count() == taken_.count());
    const Scalar cost = sound_ ? cost_of(rows_) : std::numeric_limits<Scalar>::infinity();
    if (first && !sound_) {
      status_ = refused;
      return false;
    }
    const bool lower = first || cost <= cost_ * (1 + slack);
    if (!first) {
      adapt(lower && predicted_ > 0 ? (cost_ - cost) / predicted_ : Scalar(-1));
      ++iterations_;
    }
    if (lower) {
      taken_ = rows_;
      p_ = trial_;
      cost_ = cost;
    }
    rows_ = Root();
    sound_ = true;
    if (lower && last_) {
      status_ = determined() ? converged : not_determined;
      return false;
    }
    if (iterations_ >= options_.iterations || !(damping_ < most_damping)) {
      status_ = ended();
      return false;
    }
    propose();
    return true;
  }

  LeastSquaresStatus status() const { return status_; }
  const Vector& p() const { return p_; }
  const Root& rows() const { return taken_; }  // about p()
  Scalar cost() const { return cost_; }        // V(p), S 4.5
  int iterations() const { return iterations_; }
  /// Whether p's bound k holds it against its gradient.
  bool held(int k) const { return held_[k]; }

  /// Whether the rows tell every parameter that is not held from the others: of a column of unit
  /// length more than a millionth (in float: a hundredth of a percent) is its own.
  bool determined() const {
    const auto R = free_root();
    for (int k = 0; k < N; ++k) {
      const Scalar length = R.col(k).norm();
      if (!held_[k] && !(std::abs(R(k, k)) > own_share * length)) return false;
    }
    return true;
  }

 private:
  using Square = Eigen::Matrix<Scalar, N, N>;
  using Triangle = typename Root::Triangle;
  using Flags = Eigen::Array<bool, N, 1>;

  static constexpr Scalar digits_lost = 8;
  static constexpr Scalar slack = 64 * states::rounding<Scalar>;
  static constexpr Scalar most_damping = 1e12F;
  static constexpr Scalar own_share = std::same_as<Scalar, float> ? Scalar(1e-4) : Scalar(1e-6);

  /// V at the point itself: InformationRoot::cost() is that of its solution.
  static Scalar cost_of(const Root& rows) {
    return Scalar(0.5) * rows.matrix().col(N).squaredNorm();
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

  /// [R q] of the parameters that no bound holds; columns of the others are zero.
  Square free_root() const {
    Triangle T = taken_.matrix();
    for (int k = 0; k < N; ++k) {
      if (held_[k]) T.col(k).setZero();
    }
    Triangle sorted = Triangle::Zero();
    states::absorb_rows(sorted, T);
    return sorted.template topLeftCorner<N, N>();
  }

  /// The damped step within the bounds: a parameter that would leave them goes as far as they are,
  /// and the others are solved for again; at most N times.
  void propose() {
    const Triangle& T = taken_.matrix();
    const Vector gradient =
        states::product(T.template topLeftCorner<N, N>().transpose(), T.col(N).template head<N>());
    Flags fixed;
    for (int k = 0; k < N; ++k) {
      held_[k] =
          (p_[k] <= lower_[k] && gradient[k] <= 0) || (p_[k] >= upper_[k] && gradient[k] >= 0);
      fixed[k] = held_[k];
    }
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
    trial_ = (p_ + step).cwiseMax(lower_).cwiseMin(upper_);
    const Square R = T.template topLeftCorner<N, N>();
    const Vector q = T.col(N).template head<N>();
    const Vector moved = states::product(R, step);
    predicted_ = Scalar(0.5) * (q.squaredNorm() - (q - moved).squaredNorm());
    // Damping shortens a step: near the end there is none left to speak of.
    last_ = moved.norm() * (1 + damping_) <=
            static_cast<Scalar>(options_.tolerance) +
                digits_lost * states::rounding<Scalar> * states::product(R, p_).norm();
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

  /// By the cap, or as no step made the cost fall: converged where the last was none to speak of.
  LeastSquaresStatus ended() const {
    using enum LeastSquaresStatus;
    if (!determined()) return not_determined;
    return last_ ? converged : not_converged;
  }

  RefinementOptions options_;
  Vector lower_;
  Vector upper_;
  Vector p_;
  Vector trial_;
  Root rows_ = {};   // at trial_
  Root taken_ = {};  // at p_
  Flags held_ = Flags::Constant(false);
  Scalar cost_ = std::numeric_limits<Scalar>::infinity();
  Scalar predicted_ = 0;
  Scalar damping_;
  Scalar growth_ = 2;
  int iterations_ = 0;
  bool sound_ = true;
  bool last_ = false;
  LeastSquaresStatus status_ = LeastSquaresStatus::not_converged;
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
