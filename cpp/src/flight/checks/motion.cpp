// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/motion.hpp"

#include <algorithm>
#include <cmath>

#include "flight/probes/air_columns.hpp"
#include "flight/probes/mounting.hpp"
#include "numerics/order_statistics.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/rotation.hpp"
#include "sepcal/models/pitot_static.hpp"

namespace sepcal::checks {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Columns = std::vector<const LoggedColumn*>;

Vector3d vector_at(const Columns& columns, std::size_t row) {
  return {columns[0]->values[row], columns[1]->values[row], columns[2]->values[row]};
}

/// [kg/m^3]
double density_at(const Log& log, std::size_t row) {
  if (const auto* rho = log.find("rho")) return rho->values[row];
  const Columns both = log.find_all({"ps", "temp"});
  if (both.empty()) return PitotStatic::sea_level_density;
  return probes::density_of_air(both[0]->values[row], both[1]->values[row]);
}

/// The field of the settings or of the log, in north-east-down or, where that is logged, in body
/// axes.
struct TrueField {
  std::optional<Vector3d> given;
  Columns navigation;
  Columns body;
  Columns attitude;

  std::optional<Vector3d> at(std::size_t row) const {
    if (!given && !body.empty()) return vector_at(body, row);
    if (attitude.empty() || (!given && navigation.empty())) return std::nullopt;
    const Vector3d angles = vector_at(attitude, row);
    const Vector3d b = given ? *given : vector_at(navigation, row);
    return Vector3d(body_to_ned(angles[0], angles[1], angles[2]).transpose() * b);
  }
};

TrueField find_true_field(const Log& log, const Settings& settings) {
  TrueField field{.given = {},
                  .navigation = log.find_all({"bn", "be", "bd"}),
                  .body = log.find_all({"hx", "hy", "hz"}),
                  .attitude = log.find_all({"roll", "pitch", "yaw"})};
  const auto set = settings.find("field");
  if (set != settings.end()) field.given = Vector3d(set->second[0], set->second[1], set->second[2]);
  return field;
}

/// From the sensor's axes to the body's.
Eigen::Matrix3d find_turn(const Settings& settings) {
  const auto set = settings.find("mounting");
  if (set == settings.end() || set->second.empty()) return Eigen::Matrix3d::Identity();
  return probes::turn_by({set->second[0], set->second[1], set->second[2]});
}

}  // namespace

std::vector<double> find_ground_speed(const Log& log) {
  const Columns velocity = log.find_all({"vn", "ve"});
  if (velocity.empty()) return {};
  std::vector<double> speed(log.flight().rows());
  std::ranges::transform(velocity[0]->values, velocity[1]->values, speed.begin(),
                         [](double north, double east) { return std::hypot(north, east); });
  return speed;
}

std::optional<Airspeed> find_airspeed(const Log& log) {
  if (const auto* airspeed = log.find("airspeed")) {
    return Airspeed{airspeed->values, {airspeed->header()}};
  }
  const auto* difference = log.find("dp");
  const Columns both = log.find_all({"pt", "ps"});
  if (difference == nullptr && both.empty()) return std::nullopt;
  Airspeed read;
  for (std::size_t row = 0; row < log.flight().rows(); ++row) {
    const double pressure = difference != nullptr ? difference->values[row]
                                                  : both[0]->values[row] - both[1]->values[row];
    const double square = 2 * pressure / density_at(log, row);
    read.values.push_back(square >= 0 ? std::sqrt(square) : not_a_number);
  }
  if (difference != nullptr) return Airspeed{read.values, {difference->header()}};
  return Airspeed{read.values, {both[0]->header(), both[1]->header()}};
}

std::vector<std::size_t> find_moving_rows(const std::vector<double>& speed, double share) {
  std::vector<double> ascending;
  std::ranges::copy_if(speed, std::back_inserter(ascending),
                       [](double value) { return std::isfinite(value); });
  if (ascending.empty()) return {};
  const double least = share * numerics::select_quantile(ascending, 0.9);
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < speed.size(); ++row) {
    if (speed[row] > least) rows.push_back(row);
  }
  return rows;
}

probes::Points points_of(const Eigen::MatrixX3d& columns) {
  const auto rows = static_cast<std::size_t>(columns.rows());
  return {std::span(columns.col(0).data(), rows), std::span(columns.col(1).data(), rows),
          std::span(columns.col(2).data(), rows)};
}

std::optional<FieldRows> find_field(const Log& log, const Settings& settings) {
  const Columns read = log.find_all({"mx", "my", "mz"});
  if (read.empty()) return std::nullopt;
  const TrueField field = find_true_field(log, settings);
  const bool known = log.flight().rows() > 0 && field.at(0).has_value();
  const Eigen::Matrix3d turn = find_turn(settings);
  std::vector<Vector3d> readings;
  std::vector<Vector3d> truths;
  std::vector<double> strengths;
  for (std::size_t row = 0; row < log.flight().rows(); ++row) {
    const Vector3d reading = turn * vector_at(read, row);
    const Vector3d truth = field.at(row).value_or(Vector3d::Zero());
    if (!reading.allFinite() || !truth.allFinite()) continue;
    readings.push_back(reading);
    truths.push_back(truth);
    strengths.push_back(truth.norm());
  }
  const auto rows = static_cast<Index>(readings.size());
  FieldRows found;
  found.read.resize(3, rows);
  found.truth.resize(3, known ? rows : 0);
  for (Index i = 0; i < rows; ++i) {
    found.read.col(i) = readings[static_cast<std::size_t>(i)];
    if (known) found.truth.col(i) = truths[static_cast<std::size_t>(i)];
  }
  if (known) found.strength = median(std::move(strengths));
  const auto set = settings.find("field_strength");
  if (set != settings.end()) {
    const bool is_given =
        !set->second.empty();  // else to be found in a flight of readings all round
    found.strength = is_given ? set->second.front() : not_a_number;
    found.truth.resize(3, 0);
  }
  for (const LoggedColumn* column : read) found.headers.push_back(column->header());
  found.unit = read[0]->logged.unit;
  return found;
}

}  // namespace sepcal::checks
