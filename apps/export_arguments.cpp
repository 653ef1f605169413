// SPDX-License-Identifier: BSD-3-Clause
#include "export_arguments.hpp"

#include <limits>

#include "option_values.hpp"

namespace sepcal::app {

void ExportArguments::add_to(CLI::App& verb) {
  verb.add_option("--to", target_,
                  "c or cpp, a header with the whole correction; px4 or ardupilot, parameters")
      ->type_name("c|cpp|px4|ardupilot")
      ->required();
  const auto read_sensor = [this](const std::string& text) {
    sensor_ = static_cast<std::uint32_t>(
        parse_whole_number("--sensor", text, std::numeric_limits<std::int32_t>::max()));
  };
  verb.add_option_function<std::string>(
          "--sensor", read_sensor,
          "the sensor's number, as the autopilot counts [its first]; a header's names "
          "end with it")
      ->type_name("N");
  verb.add_option("--device-id", device_id_,
                  "for PX4: the sensor's CAL_MAGn_ID, or the pressure sensor's id, which tells "
                  "its kind")
      ->type_name("ID");
  verb.add_option("--airspeed-sensor", airspeed_sensor_,
                  "for a tube: membrane, or sdp3x (SDP31, 32, 33) [by the device id or the log]")
      ->type_name("membrane|sdp3x");
  verb.add_option("--cal-air", cal_air_,
                  "for PX4 with an SDP3x: CAL_AIR_CMODEL, CAL_AIR_TUBELEN [m], CAL_AIR_TUBED_MM "
                  "[the log's, otherwise 0,0.2,1.5]")
      ->type_name("MODEL,LENGTH,DIAMETER");
  verb.add_option("--logged-airspeed", logged_airspeed_,
                  "the kind of a logged airspeed: true, or equivalent, which autopilots call "
                  "indicated [true]")
      ->type_name("true|equivalent");
  verb.add_option("--rotation", rotation_,
                  "for a magnetometer, whose rotation an autopilot can't hold: keep, the "
                  "calibration without its rotation (the symmetric factor of C^-1), or refit, "
                  "the symmetric matrix that fits the flight best [the one with the smaller "
                  "largest heading error]")
      ->type_name("keep|refit");
  verb.add_option("--mounting", mounting_,
                  "for PX4: the sensor's rotation [deg], for CAL_MAGn_ROT, if the log's readings "
                  "are in body axes")
      ->type_name("ROLL,PITCH,YAW");
  verb.add_option("--in-use", in_use_,
                  "for a logged airspeed: the ARSPD_RATIO or ASPD_SCALE_n in use when it was "
                  "logged")
      ->type_name("VALUE");
  verb.add_flag("--single,--float", options_.single,
                "for a header: computes in float, for a processor without double");
  verb.add_option("--without", options_.without,
                  "leaves an effect out and fits the rest again; may be repeated")
      ->type_name("EFFECT")
      ->take_all()
      ->allow_extra_args(false);
  verb.add_flag("--force", options_.force,
                "exports a fit that did not converge, is not fully determined, or is at a bound");
}

ExportOptions ExportArguments::resolve() const {
  ExportOptions options = options_;
  options.target = choice_of<ExportTarget>("--to", target_);
  if (sensor_) options.sensor = static_cast<int>(*sensor_);
  if (!device_id_.empty()) {
    constexpr std::uint32_t highest = std::numeric_limits<std::int32_t>::max();
    options.device_id =
        static_cast<std::uint32_t>(parse_whole_number("--device-id", device_id_, highest));
  }
  if (!in_use_.empty()) options.in_use = parse_value("--in-use", in_use_);
  if (!airspeed_sensor_.empty()) {
    options.airspeed_sensor = choice_of<AirspeedSensor>("--airspeed-sensor", airspeed_sensor_);
  }
  if (!cal_air_.empty()) {
    options.cal_air = parse_triple("--cal-air", cal_air_, "0,0.2,1.5 (model, metres, millimetres)");
  }
  if (!logged_airspeed_.empty()) {
    options.logged_airspeed = choice_of<LoggedAirspeed>("--logged-airspeed", logged_airspeed_);
  }
  if (!rotation_.empty()) options.rotation = choice_of<ExportRotation>("--rotation", rotation_);
  if (!mounting_.empty()) {
    options.mounting = parse_turn("--mounting", mounting_, "0,0,90 (roll, pitch, yaw in degrees)");
  }
  return options;
}

}  // namespace sepcal::app
