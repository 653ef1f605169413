// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/models/flight_path.hpp"
#include "numerics/order_statistics.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/short_number.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

/// The values of a column in the record's segments; none where it isn't there.
std::vector<double> values_in(const Record& record, const std::string& name) {
  std::vector<double> values;
  if (!record.has(name)) return values;
  const std::span<const double> column = record.column(name);
  for (const Segment& segment : record.segments()) {
    const auto part = column.subspan(segment.first, segment.rows());
    values.insert(values.end(), part.begin(), part.end());
  }
  return values;
}

std::string rounded(double value) { return std::to_string(std::lround(value)); }

double largest(const std::vector<double>& values) {
  double size = 0.0;
  for (const double value : values) size = std::max(size, std::abs(value));
  return size;
}

/// NaN of none.
double middle_of(std::vector<double> values) {
  return values.empty() ? not_a_number : numerics::upper_median(std::move(values));
}

void check_unit(const Record& record, const std::string& name, double most,
                const std::string& unit) {
  const double size = largest(values_in(record, name));
  if (!(size > most)) return;
  throw Error("'" + name + "' reaches " + rounded(size) + " " + unit +
              "; it is probably in degrees: convert it");
}

/// A specific force has gravity in it, and points up in flight: what most rows read says whether.
void check_specific_force(const Record& record) {
  const double middle = middle_of(values_in(record, "az"));
  constexpr double too_light = 3.0;  // m/s^2
  if (std::abs(middle) < too_light) {
    throw Error("az is " + base::short_number(middle) +
                " in the middle of its rows, and level flight must read az = -9.81; is it in g, or "
                "gravity taken out? Give specific forces in m/s^2");
  }
  if (middle > 0.0) {
    throw Error(
        "az is positive in most rows; it is the specific force along the axis that points "
        "down, and level flight must read az = -9.81: turn its sign");
  }
}

}  // namespace

void check_body_axes(const Record& record) {
  constexpr double fastest_turn = 15.0;  // rad/s
  for (const char* rate : {"p", "q", "r"}) check_unit(record, rate, fastest_turn, "rad/s");
  check_unit(record, "roll", 2.0 * std::numbers::pi, "rad");
  constexpr double beyond = 2.0;  // rad, more than a right angle
  for (const char* angle : {"alpha", "beta", "pitch"}) check_unit(record, angle, beyond, "rad");
  check_specific_force(record);
  if (middle_of(values_in(record, "airspeed")) < 0.0) {
    throw Error("airspeed is negative in most rows: turn its sign");
  }
}

void check_flight_path(const Record& record) {
  check_body_axes(record);
  const double pitch = largest(values_in(record, "pitch"));
  if (pitch > steepest_pitch) {
    throw Error("pitch reaches " + rounded(pitch * 180.0 / std::numbers::pi) +
                " deg; a flight path is reconstructed up to 85 deg: leave those rows out");
  }
}

}  // namespace sepcal
