// SPDX-License-Identifier: BSD-3-Clause
// A term of three rows on a model of two outputs.
// expect: the effect's columns are for another number of outputs than the model has
// expect: sepcal::InThreeAxes
#include "windy_tube.hpp"

namespace sepcal {

struct InThreeAxes {
  static constexpr std::array inputs{Quantity{"time", "s"}};
  static constexpr std::array linear{Quantity{"drift.s", "m/s"}};
  static constexpr std::array<Quantity, 0> nonlinear{};

  template <class U, class X>
  Vec<U, 3> columns(const Vec<U, 1>& u, const Vec<X, 0>& /*xi2*/) const {
    return {u[0], U(0.0), U(0.0)};
  }
};
static_assert(composes<InThreeAxes>);

}  // namespace sepcal
