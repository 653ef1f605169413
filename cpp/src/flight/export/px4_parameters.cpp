// SPDX-License-Identifier: BSD-3-Clause
// PX4 corrects a magnetometer by R S ((raw + P COMP) - OFF) in gauss, S symmetric with SCALE and
// ODIAG, COMP at full throttle or per kA, and an airspeed by ASPD_SCALE_n sqrt(2 dp / 1.225), the
// calibrated one, dp less SENS_DPRES_OFF.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "base/escaping.hpp"
#include "flight/export/numbered_rotations.hpp"
#include "flight/export/parameters.hpp"
#include "flight/probes/mounting.hpp"

namespace sepcal::exporting {
namespace {

constexpr double gauss = 0.01;  // in a microtesla
constexpr std::array prefixes{"X", "Y", "Z"};

void add_triple(std::vector<VehicleParameter>& parameters, const std::string& sensor,
                const std::string& what, const Eigen::Vector3d& values) {
  for (std::size_t i = 0; i < 3; ++i) {
    parameters.push_back(
        {fmt::format("{}_{}{}", sensor, prefixes[i], what), values[static_cast<Eigen::Index>(i)]});
  }
}

/// What is known in body axes, in the sensor's.
HeldField turned(HeldField held, const ExportOptions& options) {
  if (!options.mounting) return held;
  const Eigen::Matrix3d R = probes::turn_by(*options.mounting).transpose();
  held.W = R * held.W * R.transpose();
  held.n = R * held.n;
  held.kappa = R * held.kappa;
  return held;
}

/// Which of the numbered rotations R is; by its angles where it is none.
void add_mounting(const std::string& sensor, const Mounting& mounting,
                  std::vector<VehicleParameter>& parameters) {
  const std::optional<int> number = number_of(mounting);
  parameters.push_back(
      {sensor + "_ROT", static_cast<double>(number.value_or(custom_rotation)), true});
  if (number) return;
  constexpr std::array names{"_ROLL", "_PITCH", "_YAW"};
  const Mounting angles = probes::angles_of(probes::turn_by(mounting));
  for (std::size_t i = 0; i < names.size(); ++i) {
    parameters.push_back({sensor + names[i], angles[i]});
  }
}

}  // namespace

std::vector<VehicleParameter> px4_magnetometer(const HeldField& in_body,
                                               const ExportOptions& options) {
  const HeldField held = turned(in_body, options);
  const int number = sensor_of(options, 0, 3, "PX4's magnetometers");
  const std::string sensor = "CAL_MAG" + std::to_string(number);
  const double power = held.motor == Motor::current ? 1000.0 : 1.0;  // A in the unit of P
  std::vector<VehicleParameter> parameters;
  if (options.device_id) {
    parameters.push_back({sensor + "_ID", static_cast<double>(*options.device_id), true});
  }
  add_triple(parameters, sensor, "OFF", gauss * held.n);
  add_triple(parameters, sensor, "SCALE", held.W.diagonal());
  for (std::size_t i = parameters.size() - 3; i < parameters.size(); ++i) {
    check_range(parameters[i], 0.1, 3.0);
  }
  add_triple(parameters, sensor, "ODIAG", {held.W(0, 1), held.W(0, 2), held.W(1, 2)});
  add_triple(parameters, sensor, "COMP", -gauss * power * held.kappa);
  if (options.mounting) add_mounting(sensor, *options.mounting, parameters);
  if (held.motor == Motor::none) return parameters;
  parameters.push_back({"CAL_MAG_COMP_TYP", held.motor == Motor::current ? 2.0 : 1.0, true});
  return parameters;
}

std::vector<VehicleParameter> px4_airspeed(const HeldAirspeed& held, const ExportOptions& options) {
  const int number = sensor_of(options, 1, 3, "PX4's airspeeds");
  const std::vector<VehicleParameter> parameters{
      {"ASPD_SCALE_" + std::to_string(number), held.factor}, {"SENS_DPRES_OFF", held.offset}};
  check_range(parameters.front(), 0.5, 2.0);
  return parameters;
}

std::string px4_text(const std::vector<VehicleParameter>& parameters,
                     const std::vector<std::string>& comment) {
  constexpr int float_type = 9;  // MAV_PARAM_TYPE_REAL32
  constexpr int whole_type = 6;  // MAV_PARAM_TYPE_INT32
  std::string text;
  for (const std::string& line : comment) text += fmt::format("# {}\n", base::in_line(line));
  text += "#\n# Vehicle-Id Component-Id Name Value Type\n";
  for (const VehicleParameter& parameter : parameters) {
    const std::string value = parameter.whole ? fmt::format("{}", std::llround(parameter.value))
                                              : float_text(parameter.value);
    text += fmt::format("1\t1\t{}\t{}\t{}\n", parameter.name, value,
                        parameter.whole ? whole_type : float_type);
  }
  return text;
}

}  // namespace sepcal::exporting
