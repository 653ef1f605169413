/* SPDX-License-Identifier: BSD-3-Clause */
/* Example 24 from C: a two-stage start on the first rows, a piece of work a cycle, then an iterated
 * filter row by row. It prints the same numbers. */
#include "25_from_c.h"

#include <math.h>
#include <stdio.h>

/* A row of a flight in circles: the truth, with half a metre per second of something on it. */
static void fly(int k, float u[2], float z[2]) {
  const float at = (float)k;
  u[0] = 20.0F + 2.0F * sinf(0.31F * at);
  u[1] = 0.05F * at;
  z[0] = 1.05F * u[0] * cosf(u[1] + 0.1F) + 2.0F + 0.5F * sinf(12.9898F * at);
  z[1] = 1.05F * u[0] * sinf(u[1] + 0.1F) - 3.0F + 0.5F * sinf(78.233F * at);
}

static wind_box stream;

int main(void) {
  static const char* const names[wind_box_parameter_count] = {"scale", "w_n", "w_e", "heading"};
  const float noise[wind_box_readings] = {0.5F, 0.5F}; /* m/s */
  float u[wind_box_inputs];
  float z[wind_box_readings];
  float estimates[wind_box_parameter_count];
  float errors[wind_box_parameter_count];
  int k = 0;
  int end;
  int i;
  wind_box_init(&stream, noise);
  while (wind_box_status(&stream) == SEPCAL_START_COLLECTING) { /* one row a cycle */
    fly(k++, u, z);
    wind_box_add(&stream, u, z);
  }
  while (wind_box_work(&stream) == SEPCAL_START_WORKING) ++k; /* eight rows of the start a cycle */
  if (wind_box_status(&stream) != SEPCAL_START_DONE) return 1;
  printf("start: done after %d cycles\n", k);

  for (end = k + 500; k < end; ++k) {
    fly(k, u, z);
    if (wind_box_update(&stream, u, z) != SEPCAL_UPDATE_OK) return 1;
  }
  wind_box_parameters(&stream, estimates);
  wind_box_standard_errors(&stream, errors);
  for (i = 0; i < wind_box_parameter_count; ++i) {
    const int place = wind_box_parameter(names[i]);
    printf("%-8s %8.4f +- %.4f\n", names[i], (double)estimates[place], (double)errors[place]);
  }
  return 0;
}
