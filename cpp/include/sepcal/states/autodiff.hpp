// SPDX-License-Identifier: BSD-3-Clause
// Exact Jacobians for the extended filters, S 3.6, by Ceres' dual numbers. The filters themselves
// know nothing of Ceres.
#pragma once

#include <ceres/jet.h>

#include "sepcal/states/linearisation.hpp"

namespace sepcal {

/// f(x) and df/dx of a function of n_x numbers, which takes an Eigen::Vector<T, NX> and returns an
/// Eigen::Vector<T, NZ> for T a double or a dual number: a system's rate, or its outputs.
template <int NX, class Function>
auto differentiate(const Function& f, const Eigen::Vector<double, NX>& x) {
  using Jet = ceres::Jet<double, NX>;
  Eigen::Vector<Jet, NX> variables;
  for (int k = 0; k < NX; ++k) variables[k] = Jet(x[k], k);
  const auto value = f(variables).eval();
  constexpr int NZ = decltype(value)::RowsAtCompileTime;
  Linearisation<NZ, NX> result;
  for (int j = 0; j < NZ; ++j) {
    result.value[j] = value[j].a;
    result.jacobian.row(j) = value[j].v.transpose();
  }
  return result;
}

}  // namespace sepcal
