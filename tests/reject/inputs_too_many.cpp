// SPDX-License-Identifier: BSD-3-Clause
// The table names three inputs, at() takes two.
// expect: the required expression 'model.at(u, xi2)' is invalid
// expect: no matching function for call to 'sepcal::Sideslipping::at(sepcal::Vec<double, 3>&
// expect: template argument '3' does not match '2'
#include "pitot_tube.hpp"

namespace sepcal {

struct Sideslipping : PitotTube {
  static constexpr std::array inputs{Quantity{"v", "m/s"}, Quantity{"psi", "rad"},
                                     Quantity{"beta", "rad"}};
};
static_assert(SeparableModel<Sideslipping>);

}  // namespace sepcal
