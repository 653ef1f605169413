// SPDX-License-Identifier: BSD-3-Clause
// A vector's size is not known at compile time.
// expect: sepcal::Sizes<sepcal::Growing>::n_1
// expect: linear' is not usable in a constant expression
#include <vector>

#include "pitot_tube.hpp"

namespace sepcal {

struct Growing : PitotTube {
  static inline const std::vector<Quantity> linear{PitotTube::linear.begin(),
                                                   PitotTube::linear.end()};
};
static_assert(SeparableModel<Growing>);

}  // namespace sepcal
