// SPDX-License-Identifier: BSD-3-Clause
// The models of a flight program that is written in C, from_c.c.
#include "from_c.h"

#include "calibrated.hpp"
#include "link.hpp"
#include "sepcal/core_c.hpp"

double compass_centres[2];

SEPCAL_C_DEFINE_CORRECTION(compass, target::compass(compass_centres[0], compass_centres[1]));
SEPCAL_C_DEFINE_STREAM(probe, 200, 3, sepcal::FiveHoleProbe{4.5, 4.5});
SEPCAL_C_DEFINE_LEAST_SQUARES(line);

extern "C" void numbers_in(double* numbers, int count) { target::read(numbers, count); }
extern "C" void numbers_out(const double* numbers, int count) { target::write(numbers, count); }

void fly() { fly_in_c(); }
