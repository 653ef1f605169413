// SPDX-License-Identifier: BSD-3-Clause
// The effect that the cases of composition spoil in one place: wind that drifts with time.
#pragma once

#include <array>
#include <string_view>

#include "pitot_tube.hpp"
#include "sepcal/static_composition.hpp"

namespace sepcal {

struct WindDrift {
  static constexpr std::array inputs{Quantity{"time", "s"}};
  static constexpr std::array linear{Quantity{"wind[time].n", "m/s"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr std::array<std::string_view, 1> targets{"w_n"};

  template <class U, class X>
  X factor(const Vec<U, 1>& u, const Vec<X, 0>& /*xi2*/) const {
    return X(u[0]);
  }
};

/// What composing with E asks for.
template <class E>
inline constexpr bool composes = SeparableModel<decltype(PitotTube{} + E{})>;

}  // namespace sepcal
