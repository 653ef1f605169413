// SPDX-License-Identifier: BSD-3-Clause
// A model may tell what of it depends on u alone, prepare(u), and what on xi2 alone, settle(xi2),
// from which combine() makes what at() gives: the one is then computed once a row, the other once a
// point.
#pragma once

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/model.hpp"

namespace sepcal {

template <class M>
concept HoistedModel = requires(const M& model, const Vec<double, Sizes<M>::n_u>& u,
                                const Vec<double, Sizes<M>::n_2>& xi2) {
  model.combine(model.prepare(u), model.settle(xi2));
};

/// [A, b] of a sample and what moves with xi2: D = d(A xi1 + b) / dxi2 (n_z x n_2).
template <class X, int n_z, int n_1, int n_2>
struct Tangent {
  Affine<X, n_z, n_1> z;
  Eigen::Matrix<X, n_z, n_2> D;
};

/// A hoisted model may also have its tangent by hand, tangent(prepared, settled, xi1), where dual
/// numbers multiply many zeros. Lanes take it, all else takes dual numbers, and check_model() holds
/// it against differences.
template <class M>
concept HasTangent =
    HoistedModel<M> &&
    requires(const M& model, const Vec<double, Sizes<M>::n_u>& u,
             const Vec<double, Sizes<M>::n_2>& xi2, const Vec<double, Sizes<M>::n_1>& xi1) {
      model.tangent(model.prepare(u), model.settle(xi2), xi1);
    };

}  // namespace sepcal

/// The three of any model: where it doesn't tell, all is left to combine().
namespace sepcal::hoisting {

template <class M, class U>
auto prepare(const M& model, const Vec<U, Sizes<M>::n_u>& u) {
  if constexpr (HoistedModel<M>) {
    return model.prepare(u);
  } else {
    return u;
  }
}

template <class M, class X>
auto settle(const M& model, const Vec<X, Sizes<M>::n_2>& xi2) {
  if constexpr (HoistedModel<M>) {
    return model.settle(xi2);
  } else {
    return xi2;
  }
}

template <class M, class Prepared, class Settled>
auto combine(const M& model, const Prepared& prepared, const Settled& settled) {
  if constexpr (HoistedModel<M>) {
    return model.combine(prepared, settled);
  } else {
    return model.at(prepared, settled);
  }
}

}  // namespace sepcal::hoisting
