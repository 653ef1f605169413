// SPDX-License-Identifier: BSD-3-Clause
// The model that every case spoils in one place: ground velocity from a Pitot tube,
// z = k V [cos(psi + delta), sin(psi + delta)] + [w_n, w_e].
#pragma once

#include <array>
#include <cmath>

#include "sepcal/detail/model.hpp"

namespace sepcal {

struct PitotTube {
  static constexpr std::array inputs{Quantity{"v", "m/s"}, Quantity{"psi", "rad"}};
  static constexpr std::array outputs{Quantity{"vn", "m/s"}, Quantity{"ve", "m/s"}};
  static constexpr std::array linear{Quantity{"k", "1"}, Quantity{"w_n", "m/s"},
                                     Quantity{"w_e", "m/s"}};
  static constexpr std::array nonlinear{Quantity{"delta", "rad"}};

  template <class U, class X>
  Affine<X, 2, 3> at(const Vec<U, 2>& u, const Vec<X, 1>& xi2) const {
    using std::cos, std::sin;
    const X psi = u[1] + xi2[0];
    Affine<X, 2, 3> z;
    z.A << u[0] * cos(psi), X(1), X(0), u[0] * sin(psi), X(0), X(1);
    z.b.setZero();
    return z;
  }
};

}  // namespace sepcal
