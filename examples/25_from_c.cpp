// SPDX-License-Identifier: BSD-3-Clause
// The one file of C++ of a flight program in C: its models. The start keeps 60 rows, and refines
// the best 3 of its points.
#include "25_from_c.h"

#include <sepcal/core_c.hpp>

#include "24_wind_box.hpp"

SEPCAL_C_DEFINE_STREAM(wind_box, 60, 3, WindBox{});
