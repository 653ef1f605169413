// SPDX-License-Identifier: BSD-3-Clause
// It varies a parameter of another probe.
// expect: the effect varies a linear parameter that the model doesn't have
// expect: sepcal::Vertical
#include "windy_tube.hpp"

namespace sepcal {

struct Vertical : WindDrift {
  static constexpr std::array<std::string_view, 1> targets{"w_d"};
};
static_assert(composes<Vertical>);

}  // namespace sepcal
