// SPDX-License-Identifier: BSD-3-Clause
// Maximum likelihood one sample at a time (S 5.10 to 5.13, with the trace in 5.11): the score rows
// of filter error are absorbed into the triangular factor as they come,
//   T <- QR of [sqrt(mu) T; rows],   and from time to time  theta <- theta + R^-1 q,  q <- 0,
// so that a start's information goes on as its factor, and the pass at a theta that stays is the
// batch's to the last digits. Theta moves while old rows are kept, which is what makes it
// recursive. Asks for no memory where sizes are fixed, and throws nothing.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "sepcal/detail/states/score_filter.hpp"
#include "sepcal/detail/states/triangle.hpp"

namespace sepcal {

/// Sizes as of ScoreFilter. Theta's logarithms of noises are kept as such.
template <int NX, int NW, int NZ, int N, int NV = states::times(2, NW)>
class ScoreRecursion {
 public:
  using Filter = ScoreFilter<NX, NW, NZ, N, NV>;
  static constexpr int NT = Filter::NT;
  using Theta = Eigen::Vector<double, NT>;
  using Root = Eigen::Matrix<double, NT, NT>;
  using Square = Eigen::Matrix<double, states::together(NT, 1), states::together(NT, 1)>;

  /// `R` (n_theta x n_theta, upper triangular): R'R is the information about theta at the start, a
  /// batch's, with zeros in the columns of what is held. Theta stays within the bounds.
  ScoreRecursion(Filter filter, Theta theta, const Root& R, Theta lower, Theta upper)
      : filter_(std::move(filter)),
        theta_(std::move(theta)),
        lower_(std::move(lower)),
        upper_(std::move(upper)) {
    const Eigen::Index n = theta_.size();
    T_.setZero(n + 1, n + 1);
    T_.topLeftCorner(n, n) = R;
  }

  const Theta& theta() const { return theta_; }
  const Filter& filter() const { return filter_; }
  double cost() const { return cost_; }  // V_m so far, S 5.7

  /// R'R, the information that has come so far.
  Root information_root() const {
    const Eigen::Index n = theta_.size();
    return T_.topLeftCorner(n, n);
  }

  /// The score rows of a sample join; `forgetting` is mu, 1 for none. `free` (n_theta): of theta,
  /// what is estimated.
  Innovation<NZ> update(const Eigen::Vector<double, NZ>& y,
                        const SecondOrderReading<NX, NZ, N>& expected, const Filter::Moves& free,
                        double forgetting = 1.0) {
    const Eigen::Index n = theta_.size();
    const Eigen::Vector<double, NZ> r = theta_.tail(filter_.outputs()).array().exp();
    typename Filter::Rows rows;
    const Innovation<NZ> innovation = filter_.update(y, expected, r, rows);
    if (innovation.status != FilterStatus::ok) return innovation;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!free[i]) rows.col(i).setZero();
    }
    if (forgetting < 1.0) T_ *= std::sqrt(forgetting);
    states::absorb_rows(T_, rows);
    cost_ += innovation.cost();
    return innovation;
  }

  /// As ScoreFilter's, at theta's noises.
  FilterStatus predict(const SecondOrderStep<NX, NV, N>& step, double held) {
    const Eigen::Vector<double, NW> q =
        theta_.segment(first_noise(), filter_.noises()).array().exp();
    return filter_.predict(step, q, held);
  }

  /// A new segment, of a state that is no part of theta: what is known of all else stays.
  void restart(Filter filter) {
    const Eigen::Index n_x = filter.x().size();
    const Eigen::Index first = filter.parameters();
    const Eigen::Index rest = T_.cols() - first - n_x;  // behind x(0), with the residual
    Square sorted(T_.rows(), T_.cols());
    sorted << T_.middleCols(first, n_x), T_.leftCols(first), T_.rightCols(rest);
    T_.setZero();
    states::absorb_rows(T_, sorted);
    const Square marginal = T_;
    T_.setZero();
    const Eigen::Index n = first + rest;
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = i; k < n; ++k) {
        T_(i < first ? i : i + n_x, k < first ? k : k + n_x) = marginal(n_x + i, n_x + k);
      }
    }
    filter_ = std::move(filter);
  }

  /// Moves theta to where the rows have their minimum, logarithms of noises by at most 1 and
  /// nothing beyond its bounds; x goes along. What R does not see stays.
  void step() {
    const Eigen::Index n = theta_.size();
    const Root R = T_.topLeftCorner(n, n);
    const Theta q = T_.col(n).head(n);
    Theta shift = states::solve_upper(R, q);
    for (Eigen::Index i = first_noise(); i < n; ++i) shift[i] = std::clamp(shift[i], -1.0, 1.0);
    shift = (theta_ + shift).cwiseMax(lower_).cwiseMin(upper_) - theta_;
    if (!shift.allFinite()) return;
    theta_ += shift;
    filter_.move(shift);
    // What the step left over: nothing, but where a limit held it.
    T_.col(n).head(n) = q - states::product(R, shift);
  }

 private:
  Eigen::Index first_noise() const { return filter_.parameters() + filter_.x().size(); }

  Filter filter_;
  Theta theta_;
  Theta lower_;
  Theta upper_;
  Square T_;  // n_theta + 1
  double cost_ = 0.0;
};

/// A state model's, in flight. Theta: its linear parameters, then the others, the state at the
/// start, ln of the process noises and of the outputs' noises, as the tables have them.
template <StateModel M>
class RecursiveLikelihood {
 public:
  static constexpr int n_x = StateSizes<M>::n_x;
  static constexpr int n_u = StateSizes<M>::n_u;
  static constexpr int n_z = StateSizes<M>::n_z;
  static constexpr int n_w = StateSizes<M>::n_w;
  static constexpr int n_1 = StateSizes<M>::n_1;
  static constexpr int n_p = StateSizes<M>::n_p;
  using Recursion = ScoreRecursion<n_x, n_w, n_z, n_1 + n_p, noise_parts<M>()>;
  using Theta = Recursion::Theta;
  using Root = Recursion::Root;
  using Free = Recursion::Filter::Moves;

  /// From theta's own x(0), and the information R'R about theta, a batch's; zeros: none. `free`: of
  /// theta, what is estimated.
  RecursiveLikelihood(M model, const Theta& theta, const Root& R, const Theta& lower,
                      const Theta& upper, const Free& free)
      : model_(std::move(model)),
        recursion_({theta.template segment<n_x>(n_1 + n_p), Eigen::Matrix<double, n_x, n_x>::Zero(),
                    n_1 + n_p, n_w, n_z, moves()},
                   theta, R, lower, upper),
        free_(free) {
    for (std::size_t i = 0; i < numbers_.size(); ++i) numbers_[i] = static_cast<int>(i);
  }

  const Recursion& recursion() const { return recursion_; }
  const Theta& theta() const { return recursion_.theta(); }
  Vec<double, n_x> x() const { return recursion_.filter().x(); }

  /// By z (n_z, NaN where missing) at inputs u.
  Innovation<n_z> update(const Vec<double, n_u>& u, const Vec<double, n_z>& z,
                         double forgetting = 1.0) {
    SecondOrderReading<n_x, n_z, n_1 + n_p> reading;
    second_order_reading<M>(model_, x(), u, xi1(), p(), places(), reading);
    return recursion_.update(z, reading, free_, forgetting);
  }

  /// To the next row.
  FilterStatus predict(const StateRow<M>& from, const StateRow<M>& to,
                       InputsBetweenRows inputs = InputsBetweenRows::linear, int substeps = 1) {
    const Between<M> between(from, to, inputs, {});
    const double held = is_discrete<M>() ? 1.0 : between.duration();
    SecondOrderStep<n_x, noise_parts<M>(), n_1 + n_p> step;
    const Vec<double, n_x> end =
        second_order_step<M>(model_, x(), p(), between, substeps, places(), step);
    SecondOrderNoise<n_x, n_w, n_1 + n_p> noise;
    second_order_noise<M>(model_, x(), p(), between, places(), end, step, noise);
    add_noise(step, noise, between.duration(), is_discrete<M>());
    return recursion_.predict(step, held);
  }

  /// Theta to where what has come has its minimum.
  void step() { recursion_.step(); }

 private:
  Vec<double, n_1> xi1() const { return theta().template head<n_1>(); }
  Vec<double, n_p> p() const { return theta().template segment<n_p>(n_1); }

  static Free moves() {
    Free moves = Free::Constant(true);
    if constexpr (has_linear_dynamics<M>()) {
      moves.template head<n_1>() = false;
      for (const int place : linear_dynamic_places<M>()) moves[n_1 + place] = false;
      moves.template segment<n_x>(n_1 + n_p) = false;
    }
    return moves;
  }

  /// A step that is linear in the state bends by no state.
  SecondOrderPlaces places() const {
    const std::span<const int> all(numbers_);
    return {.states = all.first(n_x),
            .parameters = all.first(n_1 + n_p),
            .outputs = all.first(n_z),
            .curves = !has_linear_dynamics<M>()};
  }

  M model_;
  Recursion recursion_;
  Free free_;
  std::array<int, static_cast<std::size_t>(n_x + n_z + n_1 + n_p)> numbers_{};  // 0, 1, ...
};

}  // namespace sepcal
