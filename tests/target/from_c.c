/* SPDX-License-Identifier: BSD-3-Clause */
/* The core from C99. In come a calibration with its rows, then a flight of a five-hole probe; out
 * come what corrections.cpp writes of the first, and of the second what probe_stream.cpp writes in
 * part. */
#include "from_c.h"

#include <stddef.h>

#include "compass_parameters.h"

static const char* const of_compass[] = {COMPASS_PARAMETERS};

static compass mag;
static probe air;
static line fitted;

static double read_one(void) {
  double number;
  numbers_in(&number, 1);
  return number;
}

static void write_one(double number) { numbers_out(&number, 1); }

static void read_many(SCALAR* numbers, int count) {
  int k;
  for (k = 0; k < count; ++k) numbers[k] = (SCALAR)read_one();
}

static void write_many(const SCALAR* numbers, int count) {
  int k;
  for (k = 0; k < count; ++k) write_one((double)numbers[k]);
}

static void correct_compass(void) {
  SCALAR m[3];
  SCALAR h[3] = {0, 0, 0};
  SCALAR u[compass_inputs] = {0};
  int known = 1;
  int k;
  int rows;
  numbers_in(compass_centres, 2);
  compass_init(&mag);
  write_one(compass_correct(&mag, u, h, h)); /* no parameter is known */
  for (k = 0; k < 24; ++k) known &= compass_set(&mag, of_compass[k], (SCALAR)read_one());
  write_one(known);
  write_one(compass_set(&mag, "n_w", 0));
  write_one(compass_input("current_b"));
  for (rows = (int)read_one(); rows > 0; --rows) {
    read_many(m, 3);
    u[compass_input("current_a")] = (SCALAR)read_one();
    u[compass_input("temp_degc")] = (SCALAR)read_one();
    write_one(compass_correct(&mag, u, m, h));
    write_many(h, 3);
  }
}

static void stream_probe(void) {
  SCALAR noise[probe_readings];
  SCALAR u[probe_inputs];
  SCALAR z[probe_readings];
  SCALAR estimates[probe_parameter_count];
  int refused = 0;
  int calls = 1;
  int rows;
  read_many(noise, probe_readings);
  probe_init(&air, noise);
  for (rows = (int)read_one(); rows > 0 && probe_status(&air) == SEPCAL_START_COLLECTING; --rows) {
    read_many(u, probe_inputs);
    read_many(z, probe_readings);
    probe_add(&air, u, z);
  }
  write_one(probe_update(&air, u, z)); /* too early */
  while (probe_work(&air) == SEPCAL_START_WORKING) ++calls;
  write_one(probe_status(&air));
  write_one(calls);
  write_one(probe_most_calls(&air));
  write_one(probe_parameter("b_va"));
  write_one(probe_parameter("eps_phi"));
  write_one(probe_input("rho"));
  probe_parameters(&air, estimates);
  write_many(estimates, probe_parameter_count);
  for (; rows > 0; --rows) {
    read_many(u, probe_inputs);
    read_many(z, probe_readings);
    refused += probe_update(&air, u, z) == SEPCAL_UPDATE_REFUSED;
  }
  probe_parameters(&air, estimates);
  write_many(estimates, probe_parameter_count);
  probe_standard_errors(&air, estimates);
  write_many(estimates, probe_parameter_count);
  write_one(refused);
}

/* z = 1, 3, 2, 6 at t = 0, 1, 2, 3, of variance 1. */
static void lay_a_line(void) {
  static const SCALAR values[4] = {1, 3, 2, 6};
  const SCALAR noise = 1;
  SCALAR found[line_parameter_count];
  int t;
  line_init(&fitted);
  write_one(line_determined(&fitted));
  for (t = 0; t < 4; ++t) {
    SCALAR row[line_parameter_count];
    row[0] = 1;
    row[1] = (SCALAR)t;
    line_absorb(&fitted, row, &values[t], &noise);
  }
  write_one(line_determined(&fitted));
  line_solution(&fitted, found);
  write_many(found, line_parameter_count);
  line_standard_errors(&fitted, found);
  write_many(found, line_parameter_count);
}

void fly_in_c(void) {
  correct_compass();
  stream_probe();
  lay_a_line();
}
