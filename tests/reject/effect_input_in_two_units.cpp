// SPDX-License-Identifier: BSD-3-Clause
// The driver is the model's airspeed, in another unit.
// expect: an input is in one unit for the model and in another for the effect
// expect: sepcal::InKnots
#include "windy_tube.hpp"

namespace sepcal {

struct InKnots : WindDrift {
  static constexpr std::array inputs{Quantity{"v", "kt"}};
};
static_assert(composes<InKnots>);

}  // namespace sepcal
