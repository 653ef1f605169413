// SPDX-License-Identifier: BSD-3-Clause
// A Pitot-static tube in flight, in a level wind, in SCALAR.
#include "calibrated.hpp"
#include "stream.hpp"

void fly() { target::stream<SCALAR, 300>(target::TubeInLevelWind{}); }
