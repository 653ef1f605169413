// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/vehicle_notes.hpp"

#include <fmt/format.h>

#include <cmath>

#include "flight/export/bodies.hpp"
#include "flight/export/exporter.hpp"
#include "flight/export/numbered_rotations.hpp"
#include "flight/export/parameters.hpp"
#include "flight/files/headers.hpp"
#include "flight/probes/mounting.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/detail/flight/read_as.hpp"

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

std::string words_of(const Mounting& mounting) {
  return fmt::format("roll {:.6g}, pitch {:.6g}, yaw {:.6g} deg", mounting[0], mounting[1],
                     mounting[2]);
}

/// How far what the fit found lies from the numbered mounting that is taken for it.
std::string name_apart(const VehicleMounting& mounting) {
  if (!mounting.found || !mounting.number) return "";
  const std::string error = mounting.standard_error > 0.0
                                ? fmt::format(" +- {:.1g}", mounting.standard_error)
                                : std::string();
  return fmt::format("; the fit found it {:.2g}{} deg from that", mounting.apart, error);
}

/// What CAL_MAGn_ROT means, and where it is of no use.
void note_px4_mounting(const VehicleMounting& mounting, int sensor,
                       std::vector<std::string>& notes) {
  if (mounting.number) {
    const NumberedRotation rotation = nearest_rotation(probes::turn_by(mounting.angles));
    notes.push_back(fmt::format(
        "CAL_MAG{0}_ROT is {1}, {2}{3}: right for a sensor outside the autopilot; one inside has "
        "-1, which PX4 sees to, and turns with SENS_BOARD_ROT, so that this has to be {1} then. "
        "CAL_MAG{0}_ROLL, PITCH and YAW, where there are any, must be 0",
        sensor, *mounting.number, name_of(rotation), name_apart(mounting)));
    return;
  }
  notes.push_back(fmt::format(
      "CAL_MAG{0}_ROT is {1}, custom, as no mounting in steps of 45 deg is near: CAL_MAG{0}_ROLL, "
      "PITCH and YAW hold {2} of a sensor outside the autopilot, from PX4 1.15 on; an older one "
      "takes {1} for no turn",
      sensor, custom_rotation, words_of(mounting.angles)));
}

/// The rotation that keep leaves out has a home in a newer PX4.
void note_custom_angles(const Calibration& given, const Calibration& held,
                        const VehicleMounting& mounting, int sensor,
                        std::vector<std::string>& notes) {
  constexpr double as_good_as_none = 0.01;  // deg
  const Eigen::Matrix3d lost = lost_rotation(given, held);
  if (angle_of(lost) < as_good_as_none) return;
  const Mounting angles = probes::angles_of(lost * probes::turn_by(mounting.angles));
  notes.push_back(fmt::format(
      "PX4 from 1.15 on has a home for the rotation of a sensor outside it: with CAL_MAG{0}_ROT "
      "{1}, CAL_MAG{0}_ROLL {2:.4f}, CAL_MAG{0}_PITCH {3:.4f} and CAL_MAG{0}_YAW {4:.4f} beside "
      "these numbers nothing is lost",
      sensor, custom_rotation, angles[0], angles[1], angles[2]));
}

/// ArduPilot's readings are turned when they are logged: what is found is on top of that.
void note_ardupilot_mounting(const VehicleMounting& mounting, const ExportOptions& options,
                             std::vector<std::string>& notes) {
  const int sensor = options.sensor.value_or(1);
  const std::string orient =
      fmt::format("COMPASS_ORIENT{}", sensor == 1 ? "" : std::to_string(sensor));
  std::string what =
      fmt::format("101, with CUST_ROT_ENABLE 1 and CUST_ROT1_ROLL, PITCH and YAW of {}",
                  words_of(mounting.angles));
  if (mounting.number) {
    const NumberedRotation rotation = nearest_rotation(probes::turn_by(mounting.angles));
    what = fmt::format("{}, {}{}", *mounting.number, name_of(rotation), name_apart(mounting));
  }
  notes.push_back(fmt::format(
      "the logged readings are turned once more, and these numbers hold behind that: where {0} was "
      "0 when they were logged, of a compass outside the autopilot, set {0} to {1}; it is not in "
      "the file",
      orient, what));
}

}  // namespace

std::string vehicle_title(const Calibration& calibration, const ExportOptions& options) {
  const bool px4 = options.target == ExportTarget::px4;
  const bool field = is_magnetometer(calibration);
  return fmt::format("{}'s {} {}", px4 ? "PX4" : "ArduPilot",
                     !field ? "airspeed"
                     : px4  ? "magnetometer"
                            : "compass",
                     options.sensor.value_or(px4 && field ? 0 : 1));
}

std::vector<std::string> field_notes(const Calibration& given, const Exported& exported,
                                     const ExportOptions& options,
                                     const std::optional<VehicleMounting>& mounting) {
  const Calibration& calibration = exported.calibration;
  std::vector<std::string> notes;
  const HeldField held = held_field(calibration);
  const bool px4 = options.target == ExportTarget::px4;
  if (px4) {
    note_px4_field(options, notes);
  } else {
    note_ardupilot_field(held, notes);
  }
  const int number = options.sensor.value_or(0);
  if (mounting && px4) {
    note_px4_mounting(*mounting, number, notes);
    if (exported.rotation == ExportRotation::keep) {
      note_custom_angles(given, calibration, *mounting, number, notes);
    }
  } else if (mounting) {
    note_ardupilot_mounting(*mounting, options, notes);
  }
  if (held.motor != Motor::none) {
    notes.push_back(
        fmt::format("{} is set, which switches the compensation by {} on for every {}",
                    px4 ? "CAL_MAG_COMP_TYP" : "COMPASS_MOTCT",
                    held.motor == Motor::current ? "the battery's current" : "the throttle",
                    px4 ? "magnetometer" : "compass"));
  }
  return notes;
}

std::vector<std::string> airspeed_notes(const ChosenTubeReader& chosen,
                                        const ExportOptions& options) {
  const bool px4 = options.target == ExportTarget::px4;
  const TubeReader& reader = chosen.reader;
  std::vector<std::string> notes = chosen.notes;
  if (reader.has_airspeed && !options.in_use) {
    const bool is_true = reader.logged == LoggedAirspeed::true_airspeed;
    notes.push_back(fmt::format(
        "what was read is a logged airspeed, taken as the {} one, read with {}; give the one in "
        "use where the autopilot that logged it had another",
        is_true ? "true" : "equivalent",
        px4 ? "an ASPD_SCALE of 1"
            : fmt::format("an ARSPD_RATIO of {:.4g}", plain_ratio_of(reader.sensor.flows()))));
  }
  if (px4) {
    notes.emplace_back(
        "ASPD_SCALE_n holds from the next start of the autopilot on, and stays where "
        "ASPD_SCALE_APPLY is 0");
    notes.emplace_back(
        "add the offset to what was taken off the logged pressure already; from 2026 on PX4 has "
        "CAL_DPRESn_OFF for SENS_DPRES_OFF");
    return notes;
  }
  notes.emplace_back("ArduPilot keeps the ratio where AUTOCAL is 0");
  notes.emplace_back(reader.has_offset
                         ? "it keeps the offset where SKIP_CAL is 1, else it measures that at each "
                           "start; add the offset to what was taken off the logged pressure already"
                         : "it sets an SDP3x's offset to zero, so that none is in the file");
  return notes;
}

void drop_rotation(bool is_known, Approximation& approximation) {
  if (!is_known) {
    approximation.dropped.emplace_back(
        "nothing, as the field's strength was all that was fitted; a rotation between sensor and "
        "body was not seen and is not corrected");
    return;
  }
  if (approximation.rotation_deg == 0.0) {
    approximation.dropped.emplace_back("nothing, as the calibration does not turn the sensor");
    return;
  }
  approximation.dropped.push_back(fmt::format(
      "the rotation between sensor and body, {:.3g} deg, has no home but the mounting itself",
      approximation.rotation_deg));
}

void drop_bias(const Calibration& full, const HeldAirspeed& held, const TubeReader& reader,
               Approximation& approximation) {
  approximation.dropped.push_back(fmt::format(
      "the airspeed's constant c_va, {:.3g} m/s, for which {}", full.fit["c_va"].value,
      reader.has_offset ? fmt::format("a pressure offset of {:.3g} Pa stands", held.offset)
                        : "nothing stands"));
}

}  // namespace sepcal::exporting
