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

#include "sepcal/detail/flight/sized_effect.hpp"

namespace sepcal {

/// What is flown. rich: every maneuver. poor: straight ahead on one heading with small motions; a
/// magnetometer stays within 16 deg of level and 45 deg of one heading. third: the field's
/// directions in body axes cover one third of the sphere, magnetometer alone.
enum class Excitation { rich, poor, third };

/// How an output's noise runs in time, at one standard deviation. white: independent. ar:
/// first-order autoregressive, correlation 0.9 from row to row. pink: 1/f, the sum of first-order
/// processes of one variance whose time constants double from half a row to the record's length.
/// bursty: white, four times as strong in five bursts, all outputs at once, that take a tenth of
/// the rows.
enum class NoiseKind { white, ar, pink, bursty };

/// The choice of that name. Throws Error listing the names.
Excitation find_excitation(std::string_view name);
NoiseKind find_noise_kind(std::string_view name);

/// How a flight is flown and sampled.
struct SimulationOptions {
  /// Sampling rate of the full flight [Hz], above 0 and at most 10,000.
  double rate = 50.0;

  /// 0: the full flight. N, up to ten million: a condensed flight with every kind of excitation,
  /// in exactly N rows spread evenly over it whatever `rate` says. 200 to 500 make a short record.
  std::size_t rows = 0;

  /// Same seed, same flight to the last bit (with the same mathematical library).
  std::uint64_t seed = 0;

  Excitation excitation = Excitation::rich;
  NoiseKind noise = NoiseKind::white;

  /// Columns decoy_1, decoy_2, ... that drive nothing, at most 1,000: in turn a random walk,
  /// sinusoids, an autoregressive process, white noise and steps.
  std::size_t decoys = 0;
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
  std::vector<SizedEffect> effects{};                 // at work in the flight
  std::string source = "truth";                       // opens messages: the file it stood in
};

/// A plain Pitot-static tube on the same aircraft: it reads s_va |v - W| + c_va + noise.
struct PitotStaticTruth {
  std::map<std::string, double> parameters{
      {"s_va", 0.95}, {"c_va", -0.6},                // [1], [m/s]
      {"w_n", -3.8},  {"w_e", 2.4},   {"w_d", 0.0},  // steady wind [m/s]
  };
  std::array<double, 1> noise{0.3};    // standard deviation of the airspeed reading [m/s]
  double altitude = 300.0;             // at the first row, geopotential [m]
  std::vector<SizedEffect> effects{};  // at work in the flight
  std::string source = "truth";        // opens messages: the file it stood in
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
  std::vector<SizedEffect> effects{};             // at work in the flight
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
  std::map<std::string, double> truth;   // parameters by name, the hidden effects' among them
  std::vector<std::string> effects;      // names of the hidden effects, aliases resolved

  std::size_t rows() const { return maneuver.size(); }

  /// One column's values. Throws Error naming the column and listing those that are there.
  const std::vector<double>& column(std::string_view name) const;
};

/// Flies the input design of Sun & Gebre-Egziabher, Table 5: 380 s to 1120 s, two wind circles, a
/// pushover-pullup, multisines, chirps and a rudder doublet, labelled wind_circle_1 ... and cruise
/// in between; the condensed flight takes 120 s from 0 s. Only vn, ve and vd carry noise, Gaussian;
/// every other column is exact. Columns: time_s, roll_rad, pitch_rad, yaw_rad (wrapped to +-pi),
/// p_radps, q_radps, r_radps, vn_mps, ve_mps, vd_mps, pt_pa, ps_pa, dpa_pa, dpb_pa, temp_k,
/// rho_kgpm3 (standard atmosphere), altitude_m, throttle, current_a, flap (0, 1 or 2, and on its
/// way for 2 s). The last four, temp_k, time, alpha and beta (as read), p, q, r and maneuver can
/// drive hidden effects.
/// Throws Error for a parameter that is unknown, missing, not finite or a scale error of -1 or
/// less, a sensitivity, noise or rate out of range, for an effect that the probe doesn't have, a
/// driver that isn't there, sizes of another number than the effect's components, and for a truth
/// that leaves the probe nothing to read.
SimulatedFlight simulate_five_hole(const FiveHoleTruth& truth = {},
                                   const SimulationOptions& options = {});

/// The same flight with a plain tube. Only the airspeed and dp, 1/2 rho airspeed^2, carry noise.
/// Columns: as simulate_five_hole() has them, with dp_pa, ps_pa, temp_k, rho_kgpm3, airspeed_mps in
/// the place of the pressures. Throws Error as simulate_five_hole() does.
SimulatedFlight simulate_pitot_static(const PitotStaticTruth& truth = {},
                                      const SimulationOptions& options = {});

/// Turns a vehicle through figure eights, banks, pitches and tumbles (so labelled) within 320 s,
/// or 80 s condensed, from 0 s. Only mx, my and mz carry noise, Gaussian. Columns: time_s, mx_ut,
/// my_ut, mz_ut, roll_rad, pitch_rad, yaw_rad (wrapped to +-pi), p_radps, q_radps, r_radps, bn_ut,
/// be_ut, bd_ut, temp_degc, current_a, throttle, voltage_v, panel_current_a. The last five, time,
/// p, q, r and maneuver can drive hidden effects. Throws Error as simulate_five_hole() does.
SimulatedFlight simulate_magnetometer(const MagnetometerTruth& truth = {},
                                      const SimulationOptions& options = {});

/// Writes one header line, then one line a row, `maneuver` last. Numbers are the shortest that
/// read back to the same double. A write that fails is left in the state of `out`: only the caller
/// knows the file's name.
void write_csv(const SimulatedFlight& flight, std::ostream& out);

}  // namespace sepcal
