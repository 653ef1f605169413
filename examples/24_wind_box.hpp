// SPDX-License-Identifier: BSD-3-Clause
// A model of one's own, for examples 24 and 25.
#pragma once

#include <array>
#include <cmath>
#include <sepcal/core.hpp>

/// An airspeed indicator and a compass against the ground velocity: scale, wind, heading error.
struct WindBox {
  static constexpr std::array inputs{sepcal::Quantity{"v", "m/s"}, sepcal::Quantity{"psi", "rad"}};
  static constexpr std::array outputs{sepcal::Quantity{"vn", "m/s"}, sepcal::Quantity{"ve", "m/s"}};
  static constexpr std::array<sepcal::Quantity, 3> linear{
      {{"scale", "1"}, {"w_n", "m/s"}, {"w_e", "m/s"}}};
  static constexpr std::array nonlinear{sepcal::Quantity{"heading", "rad", -0.5, 0.5}};
  template <class U, class X>
  sepcal::Affine<X, 2, 3> at(const sepcal::Vec<U, 2>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::cos;
    using std::sin;
    const X north = u[0] * cos(u[1] + xi2[0]);
    const X east = u[0] * sin(u[1] + xi2[0]);
    sepcal::Affine<X, 2, 3> z;
    z.A << north, X(sepcal::Real<X>(1)), X(sepcal::Real<X>(0)), east, X(sepcal::Real<X>(0)),
        X(sepcal::Real<X>(1));
    z.b << north, east;
    return z;
  }
};
