// SPDX-License-Identifier: BSD-3-Clause
// Four tables, but no function.
// expect: the required expression 'model.at(u, xi2)' is invalid
// expect: has no member named 'at'
#include "pitot_tube.hpp"

namespace sepcal {

struct Tabular {
  static constexpr auto inputs = PitotTube::inputs;
  static constexpr auto outputs = PitotTube::outputs;
  static constexpr auto linear = PitotTube::linear;
  static constexpr auto nonlinear = PitotTube::nonlinear;
};
static_assert(SeparableModel<Tabular>);

}  // namespace sepcal
