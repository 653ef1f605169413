/* SPDX-License-Identifier: BSD-3-Clause */
/* The parameters of the magnetometer in a calibration's rows, in their order, for C and C++. */
#ifndef SEPCAL_TARGET_COMPASS_PARAMETERS_H
#define SEPCAL_TARGET_COMPASS_PARAMETERS_H

#define COMPASS_PARAMETERS                                                                       \
  "lambda_x", "lambda_y", "lambda_z", "n_x", "n_y", "n_z", "bias[current_a].x",                  \
      "bias[current_a].y", "bias[current_a].z", "axis_scale[temp_degc].x",                       \
      "axis_scale[temp_degc].y", "axis_scale[temp_degc].z", "cubic_nonlinearity.d_x",            \
      "cubic_nonlinearity.d_y", "cubic_nonlinearity.d_z", "cubic_nonlinearity.c_x",              \
      "cubic_nonlinearity.c_y", "cubic_nonlinearity.c_z", "eta_x", "eta_y", "eta_z", "alpha_xy", \
      "alpha_xz", "alpha_yz"

#endif
