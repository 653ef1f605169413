/* SPDX-License-Identifier: BSD-3-Clause */
/* A flight program in C: a calibrated magnetometer, a stream of a five-hole probe and a line, in
 * SCALAR. */
#ifndef SEPCAL_TARGET_FROM_C_H
#define SEPCAL_TARGET_FROM_C_H

#include "sepcal/core_c.h"

SEPCAL_C_CORRECTION(compass, SCALAR, 5, 3, 3, 512)
SEPCAL_C_STREAM(probe, SCALAR, 14, 3, 10, 65536)
SEPCAL_C_LEAST_SQUARES(line, SCALAR, 2, 1, 256)

SEPCAL_C_BEGIN
extern double compass_centres[2]; /* of the current and of the temperature */
void numbers_in(double* numbers, int count);
void numbers_out(const double* numbers, int count);
void fly_in_c(void);
SEPCAL_C_END

#endif
