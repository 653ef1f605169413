// SPDX-License-Identifier: BSD-3-Clause
// ArduPilot corrects a compass by M s (raw + OFS) + MOT x in mG, M symmetric with DIA and ODI, s
// COMPASS_SCALE, and an airspeed by sqrt((dp - ARSPD_OFFSET) ARSPD_RATIO), the equivalent one.
#include <fmt/format.h>

#include <array>

#include "base/escaping.hpp"
#include "flight/export/parameters.hpp"

namespace sepcal::exporting {
namespace {

constexpr double milligauss = 10.0;  // in a microtesla
constexpr std::array letters{"X", "Y", "Z"};

void add_axes(std::vector<VehicleParameter>& parameters, const std::string& name,
              const Eigen::Vector3d& values) {
  for (std::size_t i = 0; i < 3; ++i) {
    parameters.push_back({name + "_" + letters[i], values[static_cast<Eigen::Index>(i)]});
  }
}

void check_last(const std::vector<VehicleParameter>& parameters, double lowest, double highest) {
  for (std::size_t i = parameters.size() - 3; i < parameters.size(); ++i) {
    check_range(parameters[i], lowest, highest);
  }
}

}  // namespace

double compass_scale(const HeldField& held) {
  const double scale = held.W.trace() / 3.0;
  return scale >= least_compass_scale && scale <= largest_compass_scale ? scale : 1.0;
}

std::vector<VehicleParameter> ardupilot_compass(const HeldField& held,
                                                const ExportOptions& options) {
  const int sensor = sensor_of(options, 1, 3, "ArduPilot's compasses");
  const std::string number = sensor == 1 ? "" : std::to_string(sensor);
  const double scale = compass_scale(held);
  const Eigen::Matrix3d M = held.W / scale;
  std::vector<VehicleParameter> parameters;
  add_axes(parameters, "COMPASS_OFS" + number, -milligauss * held.n);
  add_axes(parameters, "COMPASS_DIA" + number, M.diagonal());
  check_last(parameters, 0.2, 5.0);  // that its own calibration takes
  add_axes(parameters, "COMPASS_ODI" + number, {M(0, 1), M(0, 2), M(1, 2)});
  check_last(parameters, -1.0, 1.0);
  parameters.push_back({"COMPASS_SCALE" + number, scale});
  add_axes(parameters, "COMPASS_MOT" + number, -milligauss * (held.W * held.kappa));
  if (held.motor == Motor::none) return parameters;
  parameters.push_back({"COMPASS_MOTCT", held.motor == Motor::current ? 2.0 : 1.0, true});
  return parameters;
}

std::vector<VehicleParameter> ardupilot_airspeed(const HeldAirspeed& held, const TubeReader& reader,
                                                 const ExportOptions& options) {
  const int sensor = sensor_of(options, 1, 2, "ArduPilot's airspeeds");
  const std::string name = sensor == 1 ? "ARSPD" : "ARSPD" + std::to_string(sensor);
  const double plain = plain_ratio_of(reader.sensor.flows());
  std::vector<VehicleParameter> parameters{{name + "_RATIO", plain * held.factor * held.factor}};
  check_range(parameters.front(), 1.0, 4.0);
  if (reader.has_offset) parameters.push_back({name + "_OFFSET", held.offset});
  return parameters;
}

std::string ardupilot_text(const std::vector<VehicleParameter>& parameters,
                           const std::vector<std::string>& comment) {
  std::string text;
  for (const std::string& line : comment) text += fmt::format("# {}\n", base::in_line(line));
  for (const VehicleParameter& parameter : parameters) {
    text += fmt::format("{},{}\n", parameter.name, float_text(parameter.value));
  }
  return text;
}

}  // namespace sepcal::exporting
