// SPDX-License-Identifier: BSD-3-Clause
// The table names three linear parameters, A has two columns.
// expect: 'model.at(u, xi2)' does not satisfy return-type-requirement
// expect: _Tp = sepcal::Affine<double, 2, 2>; _Up = sepcal::Affine<double, 2, 3>
#include "pitot_tube.hpp"

namespace sepcal {

struct Narrow : PitotTube {
  template <class U, class X>
  Affine<X, 2, 2> at(const Vec<U, 2>& u, const Vec<X, 1>& xi2) const {
    const auto full = PitotTube::at(u, xi2);
    return {full.A.template leftCols<2>(), full.b};
  }
};
static_assert(SeparableModel<Narrow>);

}  // namespace sepcal
