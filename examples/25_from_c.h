/* SPDX-License-Identifier: BSD-3-Clause */
/* What 25_from_c.cpp makes for C: a stream of the model in 24_wind_box.hpp, in float, of two
 * inputs, two outputs and four parameters, in so many bytes. */
#ifndef FROM_C_H
#define FROM_C_H

#include <sepcal/core_c.h>

SEPCAL_C_STREAM(wind_box, float, 2, 2, 4, 2304)

#endif
