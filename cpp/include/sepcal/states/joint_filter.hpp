// SPDX-License-Identifier: BSD-3-Clause
// States and parameters estimated together, in flight: a filter of s = [x; xi1; p], p' = 0 and
// xi1' = 0, over any of sepcal's models. A model of samples has no x: its parameters are the state.
// The extended and the iterated extended filter (S 3.1 to 3.18), in any form of covariance.
#pragma once

#include <utility>

#include "sepcal/detail/model.hpp"
#include "sepcal/detail/states/autodiff.hpp"
#include "sepcal/detail/states/integration.hpp"
#include "sepcal/detail/states/step_noise.hpp"
#include "sepcal/states/change_test.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/iterated_update.hpp"
#include "sepcal/states/state_model.hpp"

namespace sepcal {

/// How a model's numbers stand in s: n_x states, n_1 linear parameters, n_p others (xi2).
template <class M>
struct JointSizes {
  static constexpr int n_u = Sizes<M>::n_u;
  static constexpr int n_x = 0;
  static constexpr int n_z = Sizes<M>::n_z;
  static constexpr int n_1 = Sizes<M>::n_1;
  static constexpr int n_p = Sizes<M>::n_2;
  static constexpr int n_w = 0;
  static constexpr int n = n_1 + n_p;
};
template <StateModel M>
struct JointSizes<M> : StateSizes<M> {
  static constexpr int n = StateSizes<M>::n_x + StateSizes<M>::n_1 + StateSizes<M>::n_p;
};

/// What is assumed of the time between two rows, as TrajectoryOptions have it, in flight.
struct JointStep {
  InputsBetweenRows inputs = InputsBetweenRows::linear;
  int substeps = 1;
  std::span<const int> measured = {};  // places of states that are read and not integrated
};

/// M: a SeparableModel or a StateModel. What is unfit is refused by a status and changes nothing.
template <class M, class Form = SquareRootForm<JointSizes<M>::n>>
class JointFilter {
 public:
  using Sized = JointSizes<M>;
  static constexpr int n = Sized::n;
  static constexpr int n_u = Sized::n_u;
  static constexpr int n_x = Sized::n_x;
  static constexpr int n_z = Sized::n_z;
  static constexpr int n_1 = Sized::n_1;
  static constexpr int n_p = Sized::n_p;
  static constexpr int n_w = Sized::n_w;
  using Scalar = Form::Matrix::Scalar;
  using Vector = Vec<Scalar, n>;
  using Matrix = Eigen::Matrix<Scalar, n, n>;
  using Outputs = Vec<Scalar, n_z>;
  using Covariance = Eigen::Matrix<Scalar, n_z, n_z>;

  /// `start`: s and its covariance. A batch's: Filter(xi, Form::of_information_root(R)), R the
  /// leading n columns of its triangular factor.
  JointFilter(M model, Filter<n, Form> start)
      : model_(std::move(model)), filter_(std::move(start)) {}

  const Filter<n, Form>& filter() const { return filter_; }
  Vec<Scalar, n_x> x() const { return filter_.x().template head<n_x>(); }
  Vec<Scalar, n_1> xi1() const { return filter_.x().template segment<n_1>(n_x); }
  Vec<Scalar, n_p> p() const { return filter_.x().template tail<n_p>(); }

  /// The extended filter's update by z (n_z, NaN where missing) at inputs u, noise covariance R.
  Innovation<n_z, Scalar> update(const Vec<Scalar, n_u>& u, const Outputs& z, const Covariance& R) {
    return filter_.update(z, outputs(u, filter_.x()), R);
  }

  /// The same beside a ChangeTest<n, n - n_x> of s's parameters, which is told of it.
  template <class Test>
  ChangeStatus update(const Vec<Scalar, n_u>& u, const Outputs& z, const Covariance& R,
                      Test& changes) {
    const Linearisation<n_z, n, Scalar> expected = outputs(u, filter_.x());
    const Matrix P = filter_.covariance();
    return changes.update(P, expected.jacobian, z, filter_.update(z, expected, R));
  }

  /// The iterated one's.
  Innovation<n_z, Scalar> update_iterated(const Vec<Scalar, n_u>& u, const Outputs& z,
                                          const Covariance& R,
                                          const IterationOptions& options = {}) {
    const auto at = [this, &u](const Vector& s) { return outputs(u, s); };
    return iterated_update(filter_, z, at, R, options);
  }

  /// To the next row: x by the very step that a TrajectoryModel takes, Phi = dx+/d(x, p) by dual
  /// numbers through it. Q (n_w x n_w): the density of the model's noise, (unit of the table)^2;
  /// of a model in discrete time its covariance. Writes Phi where it is asked for.
  template <StateModel S = M>
  FilterStatus predict(const StateRow<S, Scalar>& from, const StateRow<S, Scalar>& to,
                       const Eigen::Matrix<Scalar, n_w, n_w>& Q, const JointStep& how = {},
                       Matrix* Phi = nullptr) {
    const Between<M, Scalar> between(from, to, how.inputs, how.measured);
    const Vector s = filter_.x();
    const auto advance = [&]<class T>(const Vec<T, n>& at) {
      Vec<T, n> next = at;
      next.template head<n_x>() = step<M, T>(model_, at.template head<n_x>(),
                                             at.template tail<n_p>(), between, how.substeps);
      return next;
    };
    const Linearisation<n, n, Scalar> next = differentiate(advance, s);
    const Vec<Scalar, n_x> half_way = Scalar(0.5) * (s + next.value).template head<n_x>();
    Transition<n, n_x, Scalar> transition{
        next.value, next.jacobian, Eigen::Matrix<Scalar, n, n_x>::Identity(),
        noise_of_step<M, Scalar>(model_, between, half_way, s.template tail<n_p>(), Q)};
    for (const int i : how.measured) {  // what is read has no noise here
      transition.Q_d.row(i).setZero();
      transition.Q_d.col(i).setZero();
    }
    if (Phi != nullptr) *Phi = transition.Phi;
    return filter_.predict(transition);
  }

  /// The same beside a ChangeTest.
  template <class Test, StateModel S = M>
  FilterStatus predict(const StateRow<S, Scalar>& from, const StateRow<S, Scalar>& to,
                       const Eigen::Matrix<Scalar, n_w, n_w>& Q, const JointStep& how,
                       Test& changes) {
    Matrix Phi = Matrix::Identity();
    const FilterStatus status = predict(from, to, Q, how, &Phi);
    if (status == FilterStatus::ok) changes.predict(Phi);
    return status;
  }

  /// Opens what a ChangeTest found, which is forgotten there.
  template <class Test>
  void follow_change(Test& changes) {
    follow(filter_, changes.jump());
    changes.forget();
  }

  /// A new segment: x begins anew, independent of the past, with U_x'U_x its covariance; what is
  /// known of parameters stays.
  void restart(const Vec<Scalar, n_x>& x, const Eigen::Matrix<Scalar, n_x, n_x>& U_x) {
    constexpr int parameters = n - n_x;
    Eigen::Matrix<Scalar, n, parameters> rows =
        filter_.form().root().template rightCols<parameters>();
    Eigen::Matrix<Scalar, parameters, parameters> marginal =
        Eigen::Matrix<Scalar, parameters, parameters>::Zero();
    states::absorb_rows(marginal, rows);
    Matrix U = Matrix::Zero();
    U.template topLeftCorner<n_x, n_x>() = U_x;
    U.template bottomRightCorner<parameters, parameters>() = marginal;
    Vector s = filter_.x();
    s.template head<n_x>() = x;
    filter_ = Filter<n, Form>(s, Form::of_covariance_root(U));
  }

 private:
  /// h(s) = A xi1 + b with its derivatives.
  Linearisation<n_z, n, Scalar> outputs(const Vec<Scalar, n_u>& u, const Vector& s) const {
    return differentiate(
        [&]<class T>(const Vec<T, n>& at) {
          const Vec<T, n_p> p = at.template tail<n_p>();
          const auto [A, b] = [&] {
            if constexpr (n_x > 0) {
              return model_.at(Vec<T, n_x>(at.template head<n_x>()), u, p);
            } else {
              return model_.at(u, p);
            }
          }();
          Vec<T, n_z> z = b;
          for (int k = 0; k < n_1; ++k) z += A.col(k) * at[n_x + k];
          return z;
        },
        s);
  }

  M model_;
  Filter<n, Form> filter_;
};

}  // namespace sepcal
