// SPDX-License-Identifier: BSD-3-Clause
// at() takes doubles alone, so that nothing can differentiate it.
// expect: at(u, xi2) must be a template in xi2's number type
#include "pitot_tube.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

struct Undifferentiable : PitotTube {
  Affine<double, 2, 3> at(const Vec<double, 2>& u, const Vec<double, 1>& xi2) const {
    return PitotTube::at(u, xi2);
  }
};
template class StaticModel<Undifferentiable>;

}  // namespace sepcal
