// SPDX-License-Identifier: BSD-3-Clause
// Nothing is estimated.
// expect: the expression '(sepcal::Sizes<M>::n_1) + (sepcal::Sizes<M>::n_2) > 0
// expect: evaluated to 'false'
#include "pitot_tube.hpp"

namespace sepcal {

struct Parameterless : PitotTube {
  static constexpr std::array<Quantity, 0> linear{};
  static constexpr std::array<Quantity, 0> nonlinear{};
};
static_assert(SeparableModel<Parameterless>);

}  // namespace sepcal
