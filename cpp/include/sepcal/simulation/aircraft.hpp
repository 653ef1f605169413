// SPDX-License-Identifier: BSD-3-Clause
// An aircraft that flies by its own forces and moments, to try flight path reconstruction,
// equation error and output error on. It shares no equation of motion with them: velocities are
// those over the ground, attitude is a quaternion, the inertia a matrix that is inverted.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "sepcal/aircraft/geometry.hpp"
#include "sepcal/simulation/simulate.hpp"

namespace sepcal {

struct AircraftTruth {
  AircraftGeometry geometry{.area = 16.2,
                            .chord = 1.49,
                            .span = 10.9,
                            .mass = 1050.0,
                            .inertia = {1285.0, 1825.0, 2667.0, 60.0}};

  /// Aerodynamics, by geometry.rate_reference; sensors: the inertial unit logs true - b, the others
  /// (1 + lambda) true + b; the steady wind. All of them, by name.
  std::map<std::string, double> parameters{
      {"CX_0", -0.035},      {"CX_alpha", 0.25},   {"CX_alpha^2", 2.5},   {"CX_q", 0.0},
      {"CX_elevator", 0.0},  {"CY_0", 0.0},        {"CY_beta", -0.4},     {"CY_p", -0.06},
      {"CY_r", 0.25},        {"CY_aileron", 0},    {"CY_rudder", 0.19},   {"CZ_0", -0.3},
      {"CZ_alpha", -4.8},    {"CZ_q", -5.0},       {"CZ_elevator", -0.4}, {"Cl_0", 0.0},
      {"Cl_beta", -0.09},    {"Cl_p", -0.48},      {"Cl_r", 0.1},         {"Cl_aileron", -0.17},
      {"Cl_rudder", 0.014},  {"Cm_0", 0.03},       {"Cm_alpha", -0.9},    {"Cm_q", -14.0},
      {"Cm_elevator", -1.2}, {"Cn_0", 0.0},        {"Cn_beta", 0.07},     {"Cn_p", -0.04},
      {"Cn_r", -0.1},        {"Cn_aileron", 0.01}, {"Cn_rudder", -0.065}, {"b_ax", 0.0},
      {"b_ay", 0.0},         {"b_az", 0.0},                       // m/s^2
      {"b_p", 0.0},          {"b_q", 0.0},         {"b_r", 0.0},  // rad/s
      {"lambda_v", 0.0},     {"b_v", 0.0},                        // 1, m/s
      {"lambda_alpha", 0.0}, {"b_alpha", 0.0},                    // 1, rad
      {"lambda_beta", 0.0},  {"b_beta", 0.0},      {"w_n", 0.0},          {"w_e", 0.0},
      {"w_d", 0.0},  // m/s
  };
  /// Standard deviations, each channel's: m/s^2, rad/s, m/s, rad.
  std::map<std::string, double> noise{
      {"ax", 0.05},     {"ay", 0.05},      {"az", 0.05},     {"p", 0.002},    {"q", 0.002},
      {"r", 0.002},     {"airspeed", 0.2}, {"alpha", 0.003}, {"beta", 0.003}, {"roll", 0.002},
      {"pitch", 0.002}, {"yaw", 0.004},    {"vn", 0.1},      {"ve", 0.1},     {"vd", 0.1}};
  double turbulence = 0.0;             // standard deviation of gusts along each axis, m/s
  double gust_length = 150.0;          // over which they change, m
  double process_noise = 0.0;          // random angular accelerations, rad/s^2/sqrt(Hz)
  double airspeed = 55.0;              // at the start, trimmed, m/s
  double altitude = 1000.0;            // the same, geopotential, m
  std::vector<SizedEffect> effects{};  // at work in the flight
  std::string source = "truth";        // opens messages: the file it stood in
};

/// 40 s of flight from level trim: 3-2-1-1 by the elevator both ways, a sweep, doublets by aileron
/// and rudder, a pilot who levels the wings a little; with Excitation::poor the elevator's alone, a
/// fifth as large. RK4, steps of at most 2.5 ms. Columns: time_s, ax_mps2 ... az_mps2, p_radps ...
/// r_radps, airspeed_mps, alpha_rad, beta_rad, roll_rad, pitch_rad, yaw_rad, vn_mps ... vd_mps,
/// elevator_rad, aileron_rad, rudder_rad, thrust_n, rho_kgpm3, altitude_m, imu_temp_degc; the last
/// seven are exact, and vn ve vd are the inertial unit's. Hidden effects: CX[DRIVER] ...
/// Cn[DRIVER], what is added to the inertial unit's readings, accel_bias[DRIVER] and
/// gyro_bias[DRIVER] (x y z), shares of them, accel_scale[DRIVER] and gyro_scale[DRIVER] (x y z),
/// and of the airspeed's, airspeed_scale[DRIVER]; wind[DRIVER] (n e d); imu_late, airdata_late,
/// attitude_late, velocity_late and alpha_lag (tau, s); drivers are of time, alpha, beta, p_hat,
/// q_hat, r_hat, elevator, aileron, rudder, airspeed, imu_temp_degc, maneuver.
/// SimulationOptions::noise colours the readings' noise. Throws Error as simulate_five_hole() does,
/// for an aircraft that can't be (check_geometry()) or that finds no trim, and for one that tumbles
/// or leaves the air that is known.
SimulatedFlight simulate_aircraft(const AircraftTruth& truth = {},
                                  const SimulationOptions& options = {});

}  // namespace sepcal
