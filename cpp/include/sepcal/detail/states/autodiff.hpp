// SPDX-License-Identifier: BSD-3-Clause
// Exact Jacobians for the extended filters, S 3.6, by dual numbers.
#pragma once

#include "sepcal/detail/dual.hpp"
#include "sepcal/detail/states/linearisation.hpp"

namespace sepcal {

/// f(x) and df/dx of a function of n_x numbers, which takes an Eigen::Vector<T, NX> and returns an
/// Eigen::Vector<T, NZ> for T a Scalar or a dual number: a system's rate, or its outputs.
template <int NX, class Scalar, class Function>
auto differentiate(const Function& f, const Eigen::Vector<Scalar, NX>& x) {
  using Number = Dual<Scalar, NX>;
  Eigen::Vector<Number, NX> variables;
  for (int k = 0; k < NX; ++k) variables[k] = Number(x[k], k);
  const auto value = f(variables).eval();
  constexpr int NZ = decltype(value)::RowsAtCompileTime;
  Linearisation<NZ, NX, Scalar> result;
  for (int j = 0; j < NZ; ++j) {
    result.value[j] = value[j].value();
    result.jacobian.row(j) = value[j].slopes().transpose();
  }
  return result;
}

}  // namespace sepcal
