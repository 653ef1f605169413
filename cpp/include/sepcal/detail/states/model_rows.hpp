// SPDX-License-Identifier: BSD-3-Clause
// A sample of a separable model about its parameters, in flight: r = z - A xi1 - b and [A | D], D =
// d(A xi1 + b)/dxi2 by dual numbers. What a batch gathers in its triangular factor, row by row.
#pragma once

#include <cmath>
#include <limits>

#include "sepcal/detail/dual.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/states/least_squares.hpp"

namespace sepcal {

/// At xi = [xi1; xi2] (n), z (n_z, NaN where missing), noise the outputs' standard deviations
/// (n_z).
template <SeparableModel M, class Scalar>
LeastSquaresRows<Sizes<M>::n_z, Sizes<M>::n_1 + Sizes<M>::n_2, Scalar> model_rows(
    const M& model, const Vec<Scalar, Sizes<M>::n_u>& u, const Vec<Scalar, Sizes<M>::n_z>& z,
    const Vec<Scalar, Sizes<M>::n_z>& noise, const Vec<Scalar, Sizes<M>::n_1 + Sizes<M>::n_2>& xi) {
  constexpr int n_1 = Sizes<M>::n_1;
  constexpr int n_2 = Sizes<M>::n_2;
  constexpr int n_z = Sizes<M>::n_z;
  LeastSquaresRows<n_z, n_1 + n_2, Scalar> rows;
  rows.W = noise.cwiseAbs2().asDiagonal();
  rows.z = z;
  const auto fill = [&](const auto& A, const auto& b, const auto& value, const auto& slopes) {
    for (int j = 0; j < n_z; ++j) {
      auto expected = b[j];
      for (int k = 0; k < n_1; ++k) {
        expected += A(j, k) * xi[k];
        rows.H(j, k) = value(A(j, k));
      }
      rows.z[j] -= value(expected);
      // Measured, but no number by the model: not a row that is missing.
      if (!std::isnan(z[j]) && std::isnan(rows.z[j]))
        rows.z[j] = std::numeric_limits<Scalar>::infinity();
      slopes(j, expected);
    }
  };
  if constexpr (n_2 > 0) {
    using Number = Dual<Scalar, n_2>;
    Vec<Number, n_2> xi2;
    for (int i = 0; i < n_2; ++i) xi2[i] = Number(xi[n_1 + i], i);
    const auto [A, b] = model.at(u, xi2);
    fill(
        A, b, [](const Number& x) { return x.value(); },
        [&](int j, const Number& x) {
          rows.H.row(j).template tail<n_2>() = x.slopes().transpose();
        });
  } else {
    const auto [A, b] = model.at(u, Vec<Scalar, 0>());
    fill(A, b, [](Scalar x) { return x; }, [](int, Scalar) {});
  }
  return rows;
}

}  // namespace sepcal
