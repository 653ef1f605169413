// SPDX-License-Identifier: BSD-3-Clause
// What a model with a state is: x' = f(x, u, p), z = A(x, u, p) xi1 + b(x, u, p) + v, and G(x, u,
// p) before the process noise (system identification summary, S 3.1 and 3.2). A pure function of a
// sample, as a static model is; trajectory_model.hpp integrates it along a record.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <limits>
#include <string_view>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal {

/// x' of N states. Starts as NaN, as Affine does: a state whose rate is never set is seen.
template <class T, int N>
struct Rate : Vec<T, N> {
  Rate() : Vec<T, N>(Vec<T, N>::Constant(T(std::numeric_limits<double>::quiet_NaN()))) {}
  // NOLINTNEXTLINE(google-explicit-constructor): an expression is a rate
  template <class Expression>
  Rate(const Eigen::MatrixBase<Expression>& expression) : Vec<T, N>(expression) {}
};

/// The sizes of a state model, read off its tables.
template <class M>
struct StateSizes {
  static constexpr int n_u = static_cast<int>(M::inputs.size());
  static constexpr int n_x = static_cast<int>(M::states.size());
  static constexpr int n_z = static_cast<int>(M::outputs.size());
  static constexpr int n_1 = static_cast<int>(M::linear.size());
  static constexpr int n_p = static_cast<int>(M::nonlinear.size());
  static constexpr int n_w = static_cast<int>(M::noise.size());

  template <class T>
  using Result = Affine<T, n_z, n_1>;
};

/// A model in discrete time says `static constexpr bool discrete = true`, and next(x, u, p) takes
/// it from one row to the next by the former's inputs.
template <class M>
constexpr bool is_discrete() {
  if constexpr (requires { M::discrete; }) return M::discrete;
  return false;
}

/// The contract that a user's model with a state fulfils. What a concept can't check,
/// check_model() does on a few steps.
template <class M>
concept StateModel =
    // six tables of names and units, sized at compile time; `noise` may be empty
    QuantityTable<decltype(M::inputs)> && QuantityTable<decltype(M::states)> &&
    QuantityTable<decltype(M::outputs)> && QuantityTable<decltype(M::linear)> &&
    QuantityTable<decltype(M::nonlinear)> && QuantityTable<decltype(M::noise)> &&
    // something moves, something is measured
    (StateSizes<M>::n_x > 0) && (StateSizes<M>::n_z > 0) &&
    // at(x, u, p) returns A (n_z x n_1) and b (n_z)
    requires(const M& model, const Vec<double, StateSizes<M>::n_x>& x,
             const Vec<double, StateSizes<M>::n_u>& u, const Vec<double, StateSizes<M>::n_p>& p) {
      { model.at(x, u, p) } -> std::same_as<typename StateSizes<M>::template Result<double>>;
    } &&
    // rate(x, u, p) returns x' (n_x), or next(x, u, p) the next x where time is discrete
    requires(const M& model, const Vec<double, StateSizes<M>::n_x>& x,
             const Vec<double, StateSizes<M>::n_u>& u, const Vec<double, StateSizes<M>::n_p>& p) {
      requires is_discrete<M>() || requires {
        { model.rate(x, u, p) } -> std::convertible_to<Vec<double, StateSizes<M>::n_x>>;
      };
      requires !is_discrete<M>() || requires {
        { model.next(x, u, p) } -> std::convertible_to<Vec<double, StateSizes<M>::n_x>>;
      };
    };

/// Whether a model has a noise_input() of its own.
template <class M>
constexpr bool has_noise_input() {
  return requires(const M& model, const Vec<double, StateSizes<M>::n_x>& x,
                  const Vec<double, StateSizes<M>::n_u>& u,
                  const Vec<double, StateSizes<M>::n_p>& p) { model.noise_input(x, u, p); };
}

/// The state that noise k of M::noise drives, whose name it has.
template <class M>
constexpr int noise_place(int k) {
  static_assert(std::ranges::all_of(
                    M::noise, [](const Quantity& w) { return place_of(w.name, M::states) >= 0; }),
                "a noise that is no state's own needs noise_input(x, u, p)");
  return place_of(M::noise[static_cast<std::size_t>(k)].name, M::states);
}

/// G (n_x x n_w): the model's noise_input(x, u, p), or by default the columns of the identity that
/// belong to the states named in M::noise.
template <StateModel M, class X>
Eigen::Matrix<X, StateSizes<M>::n_x, StateSizes<M>::n_w> noise_input(
    const M& model, const Vec<X, StateSizes<M>::n_x>& x, const Vec<Real<X>, StateSizes<M>::n_u>& u,
    const Vec<X, StateSizes<M>::n_p>& p) {
  if constexpr (has_noise_input<M>()) {
    return model.noise_input(x, u, p);
  } else {
    using Columns = Eigen::Matrix<X, StateSizes<M>::n_x, StateSizes<M>::n_w>;
    Columns G = Columns::Constant(X(Real<X>(0)));
    for (int k = 0; k < StateSizes<M>::n_w; ++k) G(noise_place<M>(k), k) = X(Real<X>(1));
    return G;
  }
}

/// How many of p enter the dynamics and the outputs linearly beside a state that does: the fifth
/// table `linear_dynamic`, names out of M::nonlinear.
template <class M>
constexpr int linear_dynamic_count() {
  if constexpr (requires { M::linear_dynamic.size(); }) {
    return static_cast<int>(M::linear_dynamic.size());
  }
  return 0;
}

/// A model that is linear in the state, and may therefore be separated.
template <class M>
constexpr bool has_linear_dynamics() {
  return requires { M::linear_dynamic.size(); };
}

/// Their places in M::nonlinear.
template <class M>
constexpr auto linear_dynamic_places() {
  std::array<int, static_cast<std::size_t>(linear_dynamic_count<M>())> places{};
  if constexpr (has_linear_dynamics<M>()) {
    static_assert(std::ranges::all_of(
                      M::linear_dynamic,
                      [](std::string_view name) { return place_of(name, M::nonlinear) >= 0; }),
                  "linear_dynamic names parameters of the table nonlinear");
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i] = place_of(M::linear_dynamic[i], M::nonlinear);
    }
  }
  return places;
}

}  // namespace sepcal
