// SPDX-License-Identifier: BSD-3-Clause
// A count stands where the table of linear parameters should.
// expect: QuantityTable<decltype (M::linear)>
// expect: request for member 'size' in 'table', which is of non-class type 'const int'
#include "pitot_tube.hpp"

namespace sepcal {

struct Counted : PitotTube {
  static constexpr int linear = 3;
};
static_assert(SeparableModel<Counted>);

}  // namespace sepcal
