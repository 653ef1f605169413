// SPDX-License-Identifier: BSD-3-Clause
// What the logged columns say of the motion together: speeds over the ground and through the air,
// the field of the Earth in body axes.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>

#include "flight/checks/log.hpp"
#include "flight/probes/ellipsoid.hpp"

namespace sepcal::checks {

/// A probe's settings, as Probe::settings() gives them.
using Settings = std::map<std::string, std::vector<double>>;

/// Speed over the ground [m/s] in the horizontal, a value a row; empty where it was not logged.
std::vector<double> find_ground_speed(const Log& log);

/// Airspeed as the probe reads it [m/s], and the columns that it comes from.
struct Airspeed {
  std::vector<double> values;  // a value a row, NaN where there is none
  std::vector<std::string> headers;
};

/// Logged, or from the pressures and the density (of the standard atmosphere at sea level where it
/// was not logged). Nothing where neither was.
std::optional<Airspeed> find_airspeed(const Log& log);

/// Rows in which the vehicle moves: faster than a share of what nine rows in ten don't exceed.
std::vector<std::size_t> find_moving_rows(const std::vector<double>& speed, double share);

/// The field read, turned as the settings say that the sensor is mounted, and the true one in body
/// axes [uT], 3 x N, in the rows that have both.
struct FieldRows {
  Eigen::Matrix3Xd read;
  Eigen::Matrix3Xd truth;             // empty where the log and the settings don't say it
  double strength = not_a_number;     // of the true field
  std::vector<std::string> headers;   // of the readings
  const files::Unit* unit = nullptr;  // of the first of them
};

/// The columns of N points (N x 3), which must outlive it, as the ellipsoid takes them.
probes::Points points_of(const Eigen::MatrixX3d& columns);

/// Nothing where the three readings were not logged.
std::optional<FieldRows> find_field(const Log& log, const Settings& settings);

}  // namespace sepcal::checks
