// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/vehicle_notes.hpp"

#include <fmt/format.h>

#include <cmath>

#include "flight/export/bodies.hpp"
#include "flight/export/parameters.hpp"
#include "flight/files/headers.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/flight/read_as.hpp"

namespace sepcal::exporting {
namespace {

void note_px4_field(const ExportOptions& options, std::vector<std::string>& notes) {
  const int sensor = options.sensor.value_or(0);
  if (!options.device_id) {
    notes.push_back(fmt::format(
        "CAL_MAG{0}_ID is not in the file, and PX4 finds a sensor by it: load this only where the "
        "vehicle's CAL_MAG{0}_ID is that of the sensor, or give the device id",
        sensor));
  }
  if (!options.mounting) {
    notes.push_back(fmt::format(
        "no mounting is given: right where CAL_MAG{}_ROT and SENS_BOARD_ROT are 0, or where the "
        "log's readings are in the sensor's own axes; else give the mounting, roll, pitch and yaw",
        sensor));
  }
}

void note_ardupilot_field(const HeldField& held, std::vector<std::string>& notes) {
  const double scale = held.W.trace() / 3.0;
  if (compass_scale(held) != scale) {
    notes.push_back(
        fmt::format("the sensor is to be scaled by {:.4g}, and ArduPilot ignores a COMPASS_SCALE "
                    "outside {:.4g} "
                    "to {:.4g}: DIA and ODI hold all of it, exactly, beside a COMPASS_SCALE of 1",
                    scale, least_compass_scale, largest_compass_scale));
  }
  constexpr double arming_limit = 180.0;  // uT, of COMPASS_OFFS_MAX's default
  if (held.n.norm() > arming_limit) {
    notes.push_back(fmt::format(
        "the offsets come to {:.0f} mG, and ArduPilot does not arm beyond COMPASS_OFFS_MAX, 1800 "
        "unless it is raised",
        10.0 * held.n.norm()));
  }
}

void note_airspeed(bool as_speed, const ExportOptions& options, std::vector<std::string>& notes) {
  const bool px4 = options.target == ExportTarget::px4;
  if (as_speed && !options.in_use) {
    notes.push_back(fmt::format(
        "what was read is a logged airspeed, taken as the true one, sqrt(2 dp / rho), by {}; give "
        "the one in use where the autopilot that logged it had another",
        px4 ? "an ASPD_SCALE of 1" : fmt::format("an ARSPD_RATIO of {:.4g}", plain_ratio)));
  }
  notes.emplace_back(
      px4 ? "PX4 keeps the scale where ASPD_SCALE_APPLY is 0; add the offset to what was taken off "
            "the logged pressure already; from 2026 on PX4 has CAL_DPRESn_OFF for SENS_DPRES_OFF"
          : "ArduPilot keeps the ratio where AUTOCAL is 0, and the offset where SKIP_CAL is 1, "
            "else "
            "it measures that at each start; add the offset to what was taken off the logged "
            "pressure already");
}

/// Of a sensor whose readings the calibration turns into body axes first.
void note_mounting(const Mounting& mounting, const ExportOptions& options,
                   std::vector<std::string>& notes) {
  const bool px4 = options.target == ExportTarget::px4;
  const std::string parameter =
      px4 ? fmt::format("CAL_MAG{}_ROT", options.sensor.value_or(0)) : "the compass's ORIENT";
  notes.push_back(fmt::format(
      "the sensor is turned by roll {:.6g}, pitch {:.6g}, yaw {:.6g} deg: {} has to say "
      "so, which is not in the file",
      mounting[0], mounting[1], mounting[2], parameter));
}

}  // namespace

bool reads_airspeed(const Calibration& calibration, const Flight& flight) {
  std::vector<std::string> unused;
  const ReadFlight read = read_as(flight, verbs::choice_for(calibration, flight, unused));
  return files::find_quantity(read.flight, "airspeed", files::UnitKind::speed).has_value();
}

std::string vehicle_title(const Calibration& calibration, const ExportOptions& options) {
  const bool px4 = options.target == ExportTarget::px4;
  const bool field = calibration.probe->app() == "sepcal-mag";
  return fmt::format("{}'s {} {}", px4 ? "PX4" : "ArduPilot",
                     !field ? "airspeed"
                     : px4  ? "magnetometer"
                            : "compass",
                     options.sensor.value_or(px4 && field ? 0 : 1));
}

std::vector<std::string> vehicle_notes(const Calibration& calibration, const Flight* flight,
                                       const ExportOptions& options) {
  std::vector<std::string> notes;
  if (calibration.probe->app() != "sepcal-mag") {
    note_airspeed(flight != nullptr && reads_airspeed(calibration, *flight), options, notes);
    return notes;
  }
  const HeldField held = held_field(calibration);
  const bool px4 = options.target == ExportTarget::px4;
  if (px4) {
    note_px4_field(options, notes);
  } else {
    note_ardupilot_field(held, notes);
  }
  if (const auto mounting = mounting_of(calibration)) note_mounting(*mounting, options, notes);
  if (held.motor != Motor::none) {
    notes.push_back(
        fmt::format("{} is set, which switches the compensation by {} on for every {}",
                    px4 ? "CAL_MAG_COMP_TYP" : "COMPASS_MOTCT",
                    held.motor == Motor::current ? "the battery's current" : "the throttle",
                    px4 ? "magnetometer" : "compass"));
  }
  return notes;
}

void drop_rotation(bool is_known, ExportLoss& loss) {
  if (!is_known) {
    loss.dropped.emplace_back(
        "nothing, as the field's strength was all that was fitted; a rotation between sensor and "
        "body was not seen and is not corrected");
    return;
  }
  if (loss.rotation_deg == 0.0) {
    loss.dropped.emplace_back("nothing, as the calibration does not turn the sensor");
    return;
  }
  loss.dropped.push_back(fmt::format(
      "the rotation between sensor and body, {:.3g} deg, has no home but the mounting itself",
      loss.rotation_deg));
}

void drop_bias(const Calibration& full, const HeldAirspeed& held, ExportLoss& loss) {
  loss.dropped.push_back(fmt::format(
      "the airspeed's constant c_va, {:.3g} m/s, for which a pressure offset of {:.3g} Pa stands",
      full.fit["c_va"].value, held.offset));
}

}  // namespace sepcal::exporting
