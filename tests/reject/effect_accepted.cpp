// SPDX-License-Identifier: BSD-3-Clause
// The effect without a mistake, and twice under two names.
#include "windy_tube.hpp"

namespace sepcal {

struct Other : WindDrift {
  static constexpr std::array linear{Quantity{"wind[time^2].n", "m/s"}};
};
static_assert(composes<WindDrift>);
static_assert(SeparableModel<decltype(PitotTube{} + WindDrift{} + Other{})>);

}  // namespace sepcal
