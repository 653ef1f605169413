// SPDX-License-Identifier: BSD-3-Clause
// at() returns the predicted output instead of A and b.
// expect: 'model.at(u, xi2)' does not satisfy return-type-requirement
// expect: _Tp = Eigen::Matrix<double, 2, 1, 0, 2, 1>; _Up = sepcal::Affine<double, 2, 3>
#include "pitot_tube.hpp"

namespace sepcal {

struct Predicting : PitotTube {
  template <class U, class X>
  Vec<X, 2> at(const Vec<U, 2>& u, const Vec<X, 1>& xi2) const {
    return PitotTube::at(u, xi2).b;
  }
};
static_assert(SeparableModel<Predicting>);

}  // namespace sepcal
