// SPDX-License-Identifier: BSD-3-Clause
// What a model is: four tables and one function, z = A(u, xi2) xi1 + b(u, xi2) + v
// (Sun & Gebre-Egziabher, Eq. 4). A model is a pure function of a sample: it owns no data.
#pragma once

#include <concepts>
#include <limits>
#include <string_view>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal {

template <class T, int N>
using Vec = Eigen::Matrix<T, N, 1>;

/// A (n_z x n_1) and b (n_z) of one sample. Both start as NaN, so an entry that a model forgets to
/// set is seen by check_model() and by the first fit instead of passing for a number.
template <class T, int NZ, int N1>
struct Affine {
  Eigen::Matrix<T, NZ, N1> A = Eigen::Matrix<T, NZ, N1>::Constant(T(static_cast<Real<T>>(poison)));
  Eigen::Matrix<T, NZ, 1> b = Eigen::Matrix<T, NZ, 1>::Constant(T(static_cast<Real<T>>(poison)));

 private:
  static constexpr double poison = std::numeric_limits<double>::quiet_NaN();
};

/// A table: a sized, constant-expression array of Quantity (std::array; empty ones are typed
/// std::array<Quantity, 0>).
template <class Table>
concept QuantityTable = requires(const Table& table) {
  { table.size() } -> std::convertible_to<std::size_t>;
  { table.data() } -> std::convertible_to<const Quantity*>;
};

/// The place of a name in a table; -1 where it isn't there.
template <QuantityTable Table>
constexpr int place_of(std::string_view name, const Table& table) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table.data()[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

/// The sizes of a model, read off its tables.
template <class M>
struct Sizes {
  static constexpr int n_u = static_cast<int>(M::inputs.size());
  static constexpr int n_z = static_cast<int>(M::outputs.size());
  static constexpr int n_1 = static_cast<int>(M::linear.size());
  static constexpr int n_2 = static_cast<int>(M::nonlinear.size());

  template <class T>
  using Result = Affine<T, n_z, n_1>;
};

/// The contract that a user's model fulfils. What a concept can't check, check_model() does.
template <class M>
concept SeparableModel =
    // four tables of names and units, sized at compile time
    QuantityTable<decltype(M::inputs)> && QuantityTable<decltype(M::outputs)> &&
    QuantityTable<decltype(M::linear)> && QuantityTable<decltype(M::nonlinear)> &&
    // something is measured, something is estimated
    (Sizes<M>::n_z > 0) && (Sizes<M>::n_1 + Sizes<M>::n_2 > 0) &&
    // at(u, xi2) returns A (n_z x n_1) and b (n_z); const: a model has no state
    requires(const M& model, const Vec<double, Sizes<M>::n_u>& u,
             const Vec<double, Sizes<M>::n_2>& xi2) {
      { model.at(u, xi2) } -> std::same_as<typename Sizes<M>::template Result<double>>;
    };

/// A model as everything below the waist takes it, in static_model.hpp: who calls fit() or its like
/// with a model of their own includes that, or sepcal.hpp.
template <SeparableModel M>
class StaticModel;

/// A model or effect whose at() takes dual numbers for the inputs, too, says
/// `static constexpr bool dual_inputs = true`: then effects correct its inputs by exact
/// derivatives; else by numeric differences, and at() only ever sees inputs in double (but for
/// input corrections composed at compile time).
template <class M>
constexpr bool has_dual_inputs() {
  if constexpr (requires { M::dual_inputs; }) return M::dual_inputs;
  return false;
}

/// A model whose at() also takes a NestedDual (nested_dual.hpp) for xi2 says `static constexpr bool
/// nested_duals = true`: its second derivatives, which the paper's screens ask for, are then exact;
/// else they are differences of the first.
template <class M>
constexpr bool has_nested_duals() {
  if constexpr (requires { M::nested_duals; }) return M::nested_duals;
  return false;
}

/// A model whose at() also takes an EnclosedDual (enclosed_dual.hpp) for xi2 says `static constexpr
/// bool enclosed = true`: then what is said of its cost can be proven (certificate.hpp). With
/// `dual_inputs` its inputs are Enclosures (enclosure.hpp); without, numbers of which nothing is to
/// be computed that rounds.
template <class M>
constexpr bool has_enclosures() {
  if constexpr (requires { M::enclosed; }) return M::enclosed;
  return false;
}

}  // namespace sepcal
