// SPDX-License-Identifier: BSD-3-Clause
// Nothing is measured.
// expect: the expression '(sepcal::Sizes<M>::n_z) > 0
// expect: evaluated to 'false'
#include "pitot_tube.hpp"

namespace sepcal {

struct Unmeasured : PitotTube {
  static constexpr std::array<Quantity, 0> outputs{};
};
static_assert(SeparableModel<Unmeasured>);

}  // namespace sepcal
