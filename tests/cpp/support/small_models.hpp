// SPDX-License-Identifier: BSD-3-Clause
// Models of one line each, for what the four real ones don't have: nothing linear, nothing
// nonlinear, values that are not finite.
#pragma once

#include <array>
#include <cmath>

#include "sepcal/detail/model.hpp"

namespace sepcal::test {

/// z = exp(c u): nothing linear.
struct Growth {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array<Quantity, 0> linear{};
  static constexpr std::array nonlinear{Quantity{"c", "1", -1, 1}};
  template <class U, class X>
  Affine<X, 1, 0> at(const Vec<U, 1>& u, const Vec<X, 1>& xi2) const {
    using std::exp;
    Affine<X, 1, 0> z;
    z.b << exp(xi2[0] * u[0]);
    return z;
  }
};

/// z = s u + c: nothing nonlinear.
struct Line {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"s", "1"}, Quantity{"c", "1"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  template <class U, class X>
  Affine<X, 1, 2> at(const Vec<U, 1>& u, const Vec<X, 0>&) const {
    Affine<X, 1, 2> z;
    z.A << u[0], X(1.0);
    z.b << X(0.0);
    return z;
  }
};

/// z = s sqrt(u): not finite where u < 0.
struct Root {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"s", "1"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  template <class U, class X>
  Affine<X, 1, 1> at(const Vec<U, 1>& u, const Vec<X, 0>&) const {
    using std::sqrt;
    Affine<X, 1, 1> z;
    z.A << sqrt(u[0]);
    z.b << X(0.0);
    return z;
  }
};

/// z = s cos(k u), k in units of 1e-6: a parameter of small natural size.
struct SmallParameter {
  static constexpr std::array inputs{Quantity{"u", "Pa"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"s", "1"}};
  static constexpr std::array nonlinear{Quantity{"k", "1/Pa", 0, 1e-5}};
  template <class U, class X>
  Affine<X, 1, 1> at(const Vec<U, 1>& u, const Vec<X, 1>& xi2) const {
    using std::cos;
    Affine<X, 1, 1> z;
    z.A << cos(xi2[0] * u[0]);
    z.b << X(0.0);
    return z;
  }
};

}  // namespace sepcal::test
