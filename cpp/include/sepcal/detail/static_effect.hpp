// SPDX-License-Identifier: BSD-3-Clause
// An effect written as a struct, like a model: tables and one function. A term gives columns, an
// input correction gives inputs. static_composition.hpp joins them to a model at compile time,
// run_time_effect.hpp makes effects of them that are chosen by name.
#pragma once

#include <concepts>
#include <utility>

#include "sepcal/detail/model.hpp"

namespace sepcal {

/// The number of outputs that a term's columns are for.
template <class T>
inline constexpr int outputs_of_term = decltype(std::declval<const T&>().columns(
    std::declval<Vec<double, static_cast<int>(T::inputs.size())>>(),
    std::declval<Vec<double, static_cast<int>(T::nonlinear.size())>>()))::RowsAtCompileTime;

/// Three tables (inputs, linear, nonlinear) and columns(u, xi2): what joins A, n_z x n_1, in the
/// number type of xi2. Names of parameters are "effect.component".
template <class T>
concept Term = QuantityTable<decltype(T::inputs)> && QuantityTable<decltype(T::linear)> &&
               QuantityTable<decltype(T::nonlinear)> && (T::linear.size() > 0) &&
               requires(const T& effect, const Vec<double, static_cast<int>(T::inputs.size())>& u,
                        const Vec<double, static_cast<int>(T::nonlinear.size())>& xi2) {
                 effect.columns(u, xi2);
                 requires outputs_of_term<T> > 0;
               };

/// Two tables, of which the first `corrected` inputs are replaced by correct(u, xi2).
template <class T>
concept InputCorrection =
    QuantityTable<decltype(T::inputs)> && QuantityTable<decltype(T::nonlinear)> &&
    requires(const T& effect, const Vec<double, static_cast<int>(T::inputs.size())>& u,
             const Vec<double, static_cast<int>(T::nonlinear.size())>& xi2) {
      { effect.correct(u, xi2) } -> std::same_as<Vec<double, T::corrected>>;
    };

/// A term whose columns are the model's: factor(u, xi2) times those of the linear parameters that
/// it names in `targets`, one for each of its own.
template <class T>
concept VaryingTerm =
    QuantityTable<decltype(T::inputs)> && QuantityTable<decltype(T::linear)> &&
    QuantityTable<decltype(T::nonlinear)> &&
    requires(const T& effect, const Vec<double, static_cast<int>(T::inputs.size())>& u,
             const Vec<double, static_cast<int>(T::nonlinear.size())>& xi2) {
      T::targets.size();
      effect.factor(u, xi2);
    };

template <class T>
concept StaticEffect = Term<T> || InputCorrection<T> || VaryingTerm<T>;

}  // namespace sepcal
