// SPDX-License-Identifier: BSD-3-Clause
// A five-hole probe in flight, in SCALAR.
#include "stream.hpp"

void fly() {
  const auto k = target::read_vector<double, 2>();
  target::stream<SCALAR, 200>(sepcal::FiveHoleProbe{k[0], k[1]});
}
