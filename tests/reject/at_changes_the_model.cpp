// SPDX-License-Identifier: BSD-3-Clause
// at() has the side effects of a non-const function.
// expect: the required expression 'model.at(u, xi2)' is invalid
// expect: passing 'const sepcal::Counting' as 'this' argument discards qualifiers
#include "pitot_tube.hpp"

namespace sepcal {

struct Counting : PitotTube {
  int calls = 0;
  template <class U, class X>
  Affine<X, 2, 3> at(const Vec<U, 2>& u, const Vec<X, 1>& xi2) {
    ++calls;
    return PitotTube::at(u, xi2);
  }
};
static_assert(SeparableModel<Counting>);

}  // namespace sepcal
