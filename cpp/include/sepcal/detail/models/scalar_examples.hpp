// SPDX-License-Identifier: BSD-3-Clause
// The paper's two tutorial examples (Sun & Gebre-Egziabher, Sec. III).
#pragma once

#include <array>
#include <cmath>

#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/model.hpp"

namespace sepcal {

/// z = (1 + a) cos(eta + b) + c (Eqs. 21, 22).
struct ScalarExample1 {
  static constexpr std::array inputs{Quantity{"eta", "rad"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"a", "1"}, Quantity{"c", "1"}};
  static constexpr std::array nonlinear{Quantity{"b", "rad", -0.5, 0.5}};
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;
  static constexpr bool enclosed = true;
  using LanesOf = ScalarExample1;

  template <class U, class X>
  Affine<X, 1, 2> at(const Vec<U, 1>& u, const Vec<X, 1>& xi2) const {
    using std::cos;
    const X wave = cos(u[0] + xi2[0]);
    Affine<X, 1, 2> z;
    z.A << wave, X(Real<X>(1));
    z.b << wave;
    return z;
  }
};

/// z = (1 + a) cos(eta (1 + b) + c) + d (Eq. 33; the paper's Eq. 34 prints eta + b where Eq. 33 has
/// eta (1 + b)).
struct ScalarExample2 {
  static constexpr std::array inputs{Quantity{"eta", "rad"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"a", "1"}, Quantity{"d", "1"}};
  static constexpr std::array nonlinear{Quantity{"b", "1", -0.5, 0.5},
                                        Quantity{"c", "rad", -1.0, 1.0}};
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;
  static constexpr bool enclosed = true;
  using LanesOf = ScalarExample2;

  template <class U, class X>
  Affine<X, 1, 2> at(const Vec<U, 1>& u, const Vec<X, 2>& xi2) const {
    using std::cos;
    const X wave = cos(u[0] * (Real<X>(1) + xi2[0]) + xi2[1]);
    Affine<X, 1, 2> z;
    z.A << wave, X(Real<X>(1));
    z.b << wave;
    return z;
  }
};

}  // namespace sepcal
