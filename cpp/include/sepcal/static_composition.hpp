// SPDX-License-Identifier: BSD-3-Clause
// Model + effects at compile time, for flight software: the tables are joined while compiling and
// at() is one inlined function. The rules are those of composition.hpp: inputs merge by name, input
// corrections act first and in order, then the model and every term see the corrected inputs. Only
// drivers differ: here they are inputs like any other, corrected where a correction names them.
#pragma once

#include <algorithm>
#include <array>
#include <tuple>
#include <type_traits>
#include <utility>

#include "sepcal/detail/hoisted_model.hpp"
#include "sepcal/detail/joined_tables.hpp"
#include "sepcal/detail/static_effect.hpp"

namespace sepcal {

namespace composing {

/// The linear parameters of an effect; a correction has none.
template <class E>
constexpr auto linear_of() {
  if constexpr (InputCorrection<E>) {
    return std::array<Quantity, 0>{};
  } else {
    return E::linear;
  }
}

/// Whether no parameter belongs to both; a failure's message shows the two owners.
template <class A, class B>
constexpr bool no_parameter_in_common() {
  const auto a = join(linear_of<A>(), A::nonlinear);
  const auto b = join(linear_of<B>(), B::nonlinear);
  return std::none_of(b.begin(), b.end(), [&](const Quantity& parameter) {
    return find(a, parameter.name) < a.size();
  });
}

/// Whether every linear parameter that an effect makes vary is the model's.
template <class M, class E>
constexpr bool targets_are_there() {
  if constexpr (VaryingTerm<E>) {
    return E::targets.size() == E::linear.size() &&
           std::all_of(E::targets.begin(), E::targets.end(), [](std::string_view target) {
             return find(M::linear, target) < M::linear.size();
           });
  }
  return true;
}

/// Whether a term's columns are for as many outputs as the model has.
template <class M, class E>
constexpr bool same_outputs() {
  if constexpr (Term<E>) {
    return outputs_of_term<E> == static_cast<int>(M::outputs.size());
  }
  return true;
}

}  // namespace composing

/// `model` with one effect; itself a model, so that effects add up.
template <SeparableModel M, StaticEffect E>
struct Composed {
  static_assert(composing::no_parameter_in_common<M, E>(),
                "a parameter's name belongs to the model and to the effect alike; rename one");
  static_assert(composing::same_units<M, E>(),
                "an input is in one unit for the model and in another for the effect");
  static_assert(composing::targets_are_there<M, E>(),
                "the effect varies a linear parameter that the model doesn't have");
  static_assert(composing::same_outputs<M, E>(),
                "the effect's columns are for another number of outputs than the model has");

  static constexpr auto inputs = composing::merge<M, E>();
  static constexpr auto outputs = M::outputs;
  static constexpr auto linear = composing::join(M::linear, composing::linear_of<E>());
  static constexpr auto nonlinear = composing::join(M::nonlinear, E::nonlinear);
  static constexpr bool dual_inputs =
      has_dual_inputs<M>() && (InputCorrection<E> || has_dual_inputs<E>());

  M model;
  E effect;

  template <class U, class X>
  Affine<X, Sizes<Composed>::n_z, Sizes<Composed>::n_1> at(
      const Vec<U, static_cast<int>(inputs.size())>& u,
      const Vec<X, static_cast<int>(nonlinear.size())>& xi2) const {
    const Vec<X, n_2m> of_model = xi2.template head<n_2m>();
    const Vec<X, n_2e> of_effect = xi2.template tail<n_2e>();
    if constexpr (InputCorrection<E>) {
      return model.at(correct<X>(u.template cast<X>(), of_effect), of_model);
    } else {
      return join<U, X>(model.at(select<M>(u), of_model), u, of_effect);
    }
  }

  /// The inputs that `model` sees behind this correction.
  template <class X>
  Vec<X, Sizes<M>::n_u> correct(Vec<X, static_cast<int>(inputs.size())> u,
                                const Vec<X, static_cast<int>(E::nonlinear.size())>& xi) const
    requires InputCorrection<E>
  {
    const Vec<X, E::corrected> values = effect.correct(select<E>(u), xi);
    for (int c = 0; c < E::corrected; ++c) u[position<E>(c)] = values[c];
    return select<M>(u);
  }

  /// What a model tells of itself it still tells beside an effect that leaves its inputs alone
  /// (sepcal/detail/hoisted_model.hpp).
  template <class U>
  auto prepare(const Vec<U, static_cast<int>(inputs.size())>& u) const
    requires(HoistedModel<M> && !InputCorrection<E>)
  {
    return std::pair(model.prepare(select<M>(u)), u);
  }

  template <class X>
  auto settle(const Vec<X, static_cast<int>(nonlinear.size())>& xi2) const
    requires(HoistedModel<M> && !InputCorrection<E>)
  {
    const Vec<X, n_2m> of_model = xi2.template head<n_2m>();
    const Vec<X, n_2e> of_effect = xi2.template tail<n_2e>();
    return std::pair(model.settle(of_model), of_effect);
  }

  template <class Prepared, class Settled, class U, class X>
  Affine<X, Sizes<Composed>::n_z, Sizes<Composed>::n_1> combine(
      const std::pair<Prepared, Vec<U, static_cast<int>(inputs.size())>>& row,
      const std::pair<Settled, Vec<X, static_cast<int>(E::nonlinear.size())>>& settled) const
    requires(HoistedModel<M> && !InputCorrection<E>)
  {
    return join<U, X>(model.combine(row.first, settled.first), row.second, settled.second);
  }

 private:
  static constexpr int n_u = static_cast<int>(inputs.size());
  static constexpr int n_2m = static_cast<int>(M::nonlinear.size());
  static constexpr int n_2e = static_cast<int>(E::nonlinear.size());

 public:
  /// The model's columns, as they are given, and beside them the effect's at u.
  template <class U, class X>
  auto join(const Affine<X, Sizes<M>::n_z, Sizes<M>::n_1>& of_model, const Vec<U, n_u>& u,
            const Vec<X, n_2e>& of_effect) const {
    Affine<X, Sizes<Composed>::n_z, Sizes<Composed>::n_1> z;
    z.A.template leftCols<Sizes<M>::n_1>() = of_model.A;
    if constexpr (VaryingTerm<E>) {
      for (int c = 0; c < Sizes<Composed>::n_1 - Sizes<M>::n_1; ++c) {
        z.A.col(Sizes<M>::n_1 + c) =
            of_model.A.col(target(c)) * effect.factor(select<E>(u), of_effect);
      }
    } else {
      z.A.template rightCols<Sizes<Composed>::n_1 - Sizes<M>::n_1>() =
          effect.columns(select<E>(u), of_effect).template cast<X>();
    }
    z.b = of_model.b;
    return z;
  }

 private:
  template <class Part>
  static constexpr int position(int i) {
    return composing::position<Composed, Part>(i);
  }

  template <class Part, class T>
  static auto select(const Vec<T, n_u>& u) {
    return composing::select<Composed, Part>(u);
  }

  static constexpr int target(int c) {
    return static_cast<int>(composing::find(M::linear, E::targets[static_cast<std::size_t>(c)]));
  }
};

namespace composing {

/// The model that effects were added to.
template <class M>
struct BaseOf {
  using Type = M;
};
template <class M, class E>
struct BaseOf<Composed<M, E>> : BaseOf<M> {};

template <class M>
inline constexpr bool is_corrected = false;
template <class M, InputCorrection E>
inline constexpr bool is_corrected<Composed<M, E>> = true;

/// Calls `visit(inner, u, xi2)` with the model without its input corrections, the inputs that it
/// then sees, and its own parameters.
template <class M, class X, class Visit>
auto behind_corrections(const M& model, const Vec<X, Sizes<M>::n_u>& u,
                        const Vec<X, Sizes<M>::n_2>& xi2, const Visit& visit) {
  if constexpr (is_corrected<M>) {
    constexpr int own = Sizes<std::remove_const_t<decltype(model.model)>>::n_2;
    const Vec<X, own> inner = xi2.template head<own>();
    const Vec<X, Sizes<M>::n_2 - own> of_effect = xi2.template tail<Sizes<M>::n_2 - own>();
    return behind_corrections(model.model, model.template correct<X>(u, of_effect), inner, visit);
  } else {
    return visit(model, u, xi2);
  }
}

}  // namespace composing

/// model + effect + effect ...: a model with all of them.
template <SeparableModel M, StaticEffect E>
constexpr auto operator+(M model, E effect) {
  return Composed<M, E>{std::move(model), std::move(effect)};
}

/// Corrections stay outermost, in the order in which they were added: whatever is added later sees
/// corrected inputs.
template <SeparableModel M, InputCorrection C, StaticEffect E>
constexpr auto operator+(Composed<M, C> model, E effect) {
  auto inner = std::move(model.model) + std::move(effect);
  return Composed<decltype(inner), C>{std::move(inner), std::move(model.effect)};
}

}  // namespace sepcal
