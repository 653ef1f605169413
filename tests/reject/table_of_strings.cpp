// SPDX-License-Identifier: BSD-3-Clause
// Names without units: the table's elements are no Quantity.
// expect: QuantityTable<decltype (M::linear)>
// expect: 'table.data()' does not satisfy return-type-requirement
// expect: _From = const char* const*; _To = const sepcal::Quantity*
#include "pitot_tube.hpp"

namespace sepcal {

struct Unitless : PitotTube {
  static constexpr std::array linear{"k", "w_n", "w_e"};
};
static_assert(SeparableModel<Unitless>);

}  // namespace sepcal
