// SPDX-License-Identifier: BSD-3-Clause
// A calibration as something that a vehicle loads: a C or C++ header with the whole correction, or
// the parameters of PX4 or ArduPilot, fitted anew to the flight where these can't hold all of it,
// and what that loses in numbers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/choices.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal {

enum class ExportTarget {
  c,          // a header for C99, which C++ takes too
  cpp,        // a header for C++17
  px4,        // QGroundControl's .params
  ardupilot,  // .param, NAME,VALUE
};

template <>
struct ChoiceNames<ExportTarget> {
  static constexpr std::array<std::string_view, 4> names{"c", "cpp", "px4", "ardupilot"};
};

/// The sensor at a tube, as the autopilots tell them apart.
enum class AirspeedSensor {
  membrane,  // MS4525, MS5525, ETS, ASP5033, ...: its pressure is taken as it is
  sdp3x,     // SDP31, SDP32, SDP33: air flows through it, and what that loses is added
};

template <>
struct ChoiceNames<AirspeedSensor> {
  static constexpr std::array<std::string_view, 2> names{"membrane", "sdp3x"};
};

/// A pressure sensor that PX4 has a driver for.
struct PressureSensor {
  std::string_view name;  // "SDP33"
  AirspeedSensor kind;
};

/// Of a device id as PX4 logs it, whose third byte says what it is; nothing for an unknown one.
std::optional<PressureSensor> px4_pressure_sensor(std::uint32_t device_id);

/// The pressure [Pa] at an SDP3x, of what ArduPilot's driver made of it for an ARSPD_RATIO: the
/// DiffPress of its logs. `static_pressure` in Pa, `temperature` of the sensor in K.
double sdp3x_pressure(double handed_on, double ratio, double static_pressure, double temperature);

/// What a logged airspeed is.
enum class LoggedAirspeed {
  true_airspeed,
  equivalent,  // what an autopilot calls indicated or calibrated: at sea level's density
};

template <>
struct ChoiceNames<LoggedAirspeed> {
  static constexpr std::array<std::string_view, 2> names{"true", "equivalent"};
};

/// What an autopilot's symmetric matrix is, where the calibration turns the sensor too (a
/// magnetometer in a known field): h = C^-1 (m - n), C^-1 = Q S, Q a rotation.
enum class ExportRotation {
  keep,   // S and n: the calibration as it is, less its rotation Q
  refit,  // the symmetric matrix, with its n, that fits the flight best
};

template <>
struct ChoiceNames<ExportRotation> {
  static constexpr std::array<std::string_view, 2> names{"keep", "refit"};
};

struct ExportOptions {
  ExportTarget target = ExportTarget::c;
  /// Which of the vehicle's sensors, as the target counts: n of PX4's CAL_MAGn (from 0) and
  /// ASPD_SCALE_n (from 1), 1 to 3 of ArduPilot's compasses, 1 or 2 of its airspeeds. Unset: the
  /// first. Of a header a number that its names end in, or none.
  std::optional<int> sensor = {};
  /// PX4's CAL_MAGn_ID; of a tube, the id of its pressure sensor, which says what kind it is.
  std::optional<std::uint32_t> device_id = {};
  /// ARSPD_RATIO or ASPD_SCALE_n with which a logged airspeed was read.
  std::optional<double> in_use = {};
  LoggedAirspeed logged_airspeed = LoggedAirspeed::true_airspeed;
  /// Of a tube. Unset: by device_id, else by the flight's columns air_device_id (PX4) or arspd_type
  /// (ArduPilot), else a membrane, which a note says.
  std::optional<AirspeedSensor> airspeed_sensor = {};
  /// Of PX4 with an SDP3x: CAL_AIR_CMODEL, CAL_AIR_TUBELEN [m], CAL_AIR_TUBED_MM [mm]. Unset: the
  /// flight's columns cal_air_cmodel, cal_air_tubelen_m and cal_air_tubed_mm, else PX4's defaults,
  /// 0, 0.2 and 1.5.
  std::optional<std::array<double, 3>> cal_air = {};
  /// Unset: the one with the smaller largest error of heading, of which keep takes no flight.
  std::optional<ExportRotation> rotation = {};
  /// Of PX4, roll, pitch, yaw [deg]: how the sensor is mounted. Where the calibration does not turn
  /// the readings itself, they were logged in body axes. Unset: as the calibration has it.
  std::optional<std::array<double, 3>> mounting = {};
  bool single = false;  // of a header: it computes in float, for a unit that has no double
  std::vector<std::string> without = {};  // effects that are left out; the rest is fitted anew
  bool force = false;                     // exports also what is not fit to be used
  FitProgress progress = {};
};

/// A parameter of an autopilot.
struct VehicleParameter {
  std::string name;
  double value = 0.0;
  bool whole = false;  // an integer
};

/// What the vehicle's correction lacks of the calibration's, over the rows of a flight that were
/// fitted. NaN: not known, or not of this probe.
struct Approximation {
  std::vector<std::string> dropped = {};  // in words
  std::string flight = {};
  std::size_t rows = 0;                        // that both correct
  double rotation_deg = not_a_number;          // between sensor and body, which has no home
  double heading_rms_deg = not_a_number;       // vehicle's heading less the calibration's
  double heading_largest_deg = not_a_number;   // by size
  double strength_rms_ut = not_a_number;       // the field's strength, likewise
  double airspeed_rms_mps = not_a_number;      // the true airspeed, likewise
  double airspeed_largest_mps = not_a_number;  // by size
  double residual_before = not_a_number;       // RMS of measured less modelled, of the calibration
  double residual_after = not_a_number;        // of what the vehicle holds
  std::string residual_unit = {};
};

struct Exported {
  ExportTarget target = ExportTarget::c;
  Calibration calibration;  // that the file holds: the one given, or fitted anew
  std::string text = {};    // of the file
  std::vector<VehicleParameter> parameters = {};    // of an autopilot, in the file's order
  std::vector<std::string> left_to_others = {};     // effects that act on the reference or the wind
  std::optional<Approximation> approximation = {};  // none where nothing was changed
  std::optional<ExportRotation> rotation = {};      // that was taken, where there was a choice
  std::optional<Approximation> other_approximation =
      {};                               // of the other one; none where it has none
  std::vector<std::string> notes = {};  // one line each, for people
};

/// The calibration for a vehicle. `flight`: to refit to and to compare on; without, the file that
/// the calibration names, where it is there unchanged. Throws Error in one line for a calibration
/// that is not fit to be used (unless forced), an effect that the vehicle can't follow, a value
/// beyond what the autopilot takes, and a flight that is needed and not there.
Exported export_calibration(const Calibration& calibration, const Flight* flight,
                            const ExportOptions& options);

/// The same to a file that appears whole or not at all. Throws Error also where `output` can't be
/// written, or is one of the files that are read.
Exported export_to_file(const Calibration& calibration, const Flight* flight,
                        const ExportOptions& options, const std::string& output);

/// What was written to `output` and what is lost, for people; the JSON says the same.
std::string to_text(const Exported& exported, const std::string& output);
std::string to_json(const Exported& exported, const std::string& output);

}  // namespace sepcal
