// SPDX-License-Identifier: BSD-3-Clause
// Flights from physics, to try a calibration on: a motion is chosen, the air or the Earth's field
// at the sensor follows from it, and the sensor's reading from that. Nothing here runs an
// estimation model backwards or shares code with one. Units SI, angles rad, fields uT; NED, body
// axes FRD.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal {

/// How a flight is sampled.
struct SimulationOptions {
  /// Sampling rate of the full flight [Hz], above 0 and at most 10,000.
  double rate = 50.0;

  /// 0: the full flight. N, up to ten million: a condensed flight with every kind of excitation,
  /// in exactly N rows spread evenly over it whatever `rate` says. 200 to 500 make a short record.
  std::size_t rows = 0;

  /// Same seed, same flight to the last bit (with the same mathematical library).
  std::uint64_t seed = 0;
};

/// A five-hole probe on a small fixed-wing aircraft. `parameters` holds each of the names below.
struct FiveHoleTruth {
  std::map<std::string, double> parameters{
      {"lambda_va", 0.05},    {"b_va", 0.6},                      // [1], [m/s]
      {"w_n", -3.8},          {"w_e", 2.4},        {"w_d", 0.3},  // steady wind [m/s]
      {"lambda_alpha", 0.08}, {"b_alpha", -0.035},                // [1], [rad]
      {"lambda_beta", -0.06}, {"b_beta", 0.02},                   // [1], [rad]
      {"eps_phi", 0.05},                                          // [rad]
  };
  double k_alpha = 4.5;                               // sensitivity [1/rad], above 0
  double k_beta = 4.5;                                // sensitivity [1/rad], above 0
  std::array<double, 3> lever_arm{0.35, 0.0, -0.02};  // velocity's reference to probe, body [m]
  std::array<double, 3> noise{0.15, 0.15, 0.15};      // standard deviation of vn, ve, vd [m/s]
  double altitude = 300.0;                            // at the first row, geopotential [m]
  std::string source = "truth";                       // opens messages: the file it stood in
};

/// A magnetometer on a vehicle that turns through the whole sphere. The reading is
/// C_alpha (I + [eta x]) (I + diag lambda) h + n + noise, C_alpha symmetric with a unit diagonal.
struct MagnetometerTruth {
  std::map<std::string, double> parameters{
      {"lambda_x", 0.04}, {"lambda_y", -0.03},  {"lambda_z", 0.02},  // [1]
      {"n_x", 12.0},      {"n_y", -7.0},        {"n_z", 5.0},        // [uT]
      {"eta_x", 0.03},    {"eta_y", -0.02},     {"eta_z", 0.04},     // [rad]
      {"alpha_xy", 0.02}, {"alpha_xz", -0.015}, {"alpha_yz", 0.01},  // [1]
  };
  std::array<double, 3> field{19.7, -1.4, 49.4};  // the Earth's, north, east, down [uT]
  std::array<double, 3> noise{0.3, 0.3, 0.3};     // standard deviation of mx, my, mz [uT]
  std::string source = "truth";                   // opens messages: the file it stood in
};

/// A column of a CSV: its header, `<quantity>_<unit>`, and one value a row.
struct SimulatedColumn {
  std::string name;
  std::vector<double> values;
};

struct SimulatedFlight {
  std::vector<SimulatedColumn> columns;  // in the order of the file, all of one length
  std::vector<std::string> maneuver;     // one label a row
  std::map<std::string, double> truth;   // parameters by name

  std::size_t rows() const { return maneuver.size(); }

  /// One column's values. Throws Error naming the column and listing those that are there.
  const std::vector<double>& column(std::string_view name) const;
};

/// Flies the input design of Sun & Gebre-Egziabher, Table 5: 380 s to 1120 s, two wind circles, a
/// pushover-pullup, multisines, chirps and a rudder doublet, labelled wind_circle_1 ... and cruise
/// in between; the condensed flight takes 120 s from 0 s. Only vn, ve and vd carry noise, white and
/// Gaussian; every other column is exact. Columns: time_s, roll_rad, pitch_rad, yaw_rad (wrapped
/// to +-pi), p_radps, q_radps, r_radps, vn_mps, ve_mps, vd_mps, pt_pa, ps_pa, dpa_pa, dpb_pa,
/// temp_k, rho_kgpm3 (standard atmosphere), altitude_m, throttle, current_a.
/// Throws Error for a parameter that is unknown, missing, not finite or a scale error of -1 or
/// less, a sensitivity, noise or rate out of range, and for a truth that leaves the probe nothing
/// to read.
SimulatedFlight simulate_five_hole(const FiveHoleTruth& truth = {},
                                   const SimulationOptions& options = {});

/// Turns a vehicle through figure eights, banks, pitches and tumbles (so labelled) within 320 s,
/// or 80 s condensed, from 0 s. Only mx, my and mz carry noise, white and Gaussian. Columns:
/// time_s, mx_ut, my_ut, mz_ut, roll_rad, pitch_rad, yaw_rad (wrapped to +-pi), p_radps, q_radps,
/// r_radps, bn_ut, be_ut, bd_ut, temp_degc, current_a. Throws Error as simulate_five_hole() does.
SimulatedFlight simulate_magnetometer(const MagnetometerTruth& truth = {},
                                      const SimulationOptions& options = {});

/// Writes one header line, then one line a row, `maneuver` last. Numbers are the shortest that
/// read back to the same double. A write that fails is left in the state of `out`: only the caller
/// knows the file's name.
void write_csv(const SimulatedFlight& flight, std::ostream& out);

}  // namespace sepcal
