// SPDX-License-Identifier: BSD-3-Clause
// The table of nonlinear parameters was forgotten.
// expect: QuantityTable<decltype (M::nonlinear)>
// expect: 'nonlinear' is not a member of 'sepcal::ThreeTables'
#include "pitot_tube.hpp"

namespace sepcal {

struct ThreeTables {
  static constexpr auto inputs = PitotTube::inputs;
  static constexpr auto outputs = PitotTube::outputs;
  static constexpr auto linear = PitotTube::linear;

  template <class U, class X>
  Affine<X, 2, 3> at(const Vec<U, 2>& u, const Vec<X, 1>& xi2) const {
    return PitotTube().at(u, xi2);
  }
};
static_assert(SeparableModel<ThreeTables>);

}  // namespace sepcal
