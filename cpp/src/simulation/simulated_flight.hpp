// SPDX-License-Identifier: BSD-3-Clause
// What the simulators share: quantities that move, attitude, smooth onsets, the standard
// atmosphere, and the table that a flight is written into. Private to the simulators.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/simulation/simulate.hpp"

namespace sepcal::simulation {

inline constexpr double pi = std::numbers::pi;
inline constexpr double standard_gravity = 9.80665;  // [m/s^2]
inline constexpr double longest_shift = 10.0;        // of any reading or driver in time [s]
inline constexpr double longest_lag = 2.0;           // time constant [s]

/// A quantity and its time derivative: body rates follow from it exactly.
struct Moving {
  double value = 0.0;
  double rate = 0.0;

  constexpr Moving(double value_ = 0.0, double rate_ = 0.0) : value(value_), rate(rate_) {}

  Moving& operator+=(Moving other) { return *this = {value + other.value, rate + other.rate}; }
};

inline Moving operator+(Moving a, Moving b) { return a += b; }
inline Moving operator-(Moving a) { return {-a.value, -a.rate}; }
inline Moving operator-(Moving a, Moving b) { return a + -b; }
inline Moving operator*(Moving a, Moving b) {
  return {a.value * b.value, a.rate * b.value + a.value * b.rate};
}
inline Moving operator/(Moving a, Moving b) {
  const double ratio = a.value / b.value;
  return {ratio, (a.rate - ratio * b.rate) / b.value};
}
inline Moving sin(Moving a) { return {std::sin(a.value), a.rate * std::cos(a.value)}; }
inline Moving cos(Moving a) { return {std::cos(a.value), -a.rate * std::sin(a.value)}; }

/// 0 before x = 0, 1 after x = 1, twice differentiable between.
Moving step(Moving x);

/// The integral of step() over x.
Moving ramp(Moving x);

/// 1 within 0 < x < 1 but for smooth edges, each `edge` wide; 0 outside.
Moving window(Moving x, double edge = 0.15);

/// The 3-2-1 Euler angles from body to NED [rad].
struct Attitude {
  Moving roll;
  Moving pitch;
  Moving yaw;

  /// Turns body axes into NED, (3 x 3): yaw about down, then pitch about right, then roll about
  /// forward.
  Eigen::Matrix3d body_to_ned() const;

  /// p, q, r [rad/s], the exact kinematics of the angles.
  Eigen::Vector3d body_rates() const;
};

/// An angle in [-pi, pi] [rad].
inline double wrap(double angle) { return std::remainder(angle, 2.0 * pi); }

/// Air at rest.
struct Air {
  double pressure;     // [Pa]
  double temperature;  // [K]
  double density;      // [kg/m^3]
};

/// The international standard atmosphere (ISO 2533) at a geopotential altitude [m].
/// Throws Error outside its lowest layer, -2,000 m to 11,000 m.
Air standard_air(double altitude);

/// Full flight: begin, begin + 1/rate, ... up to end. Condensed: `options.rows` times evenly from
/// begin, end excluded. All in s. Throws Error for a rate or a number of rows out of range.
std::vector<double> sample_times(double begin, double end, const SimulationOptions& options);

/// Throws Error, opened by `source`, unless `parameters` holds exactly the names of `defaults`,
/// every value is finite and every scale error (lambda_*) above -1.
void check_parameters(const std::string& source, const std::map<std::string, double>& parameters,
                      const std::map<std::string, double>& defaults);

/// Throws Error, opened by `source` and naming `what`, unless every value is finite and at least
/// `lowest`.
void check_values(const std::string& source, std::string_view what, std::span<const double> values,
                  double lowest = -std::numeric_limits<double>::infinity());

/// An empty flight with these columns.
SimulatedFlight open_flight(std::initializer_list<std::string_view> names, std::size_t rows);

/// Appends one row; `values` are in the order of the columns.
void append_row(SimulatedFlight& flight, std::string_view maneuver,
                std::initializer_list<double> values);

/// A sum of three sines of unlike periods, 7 s to 25 s, within +-1: a smooth course that has
/// nothing to do with the motion. Another `course`, another one.
double wander(double time, int course);

/// The shortest decimal that reads back to the same double.
std::string format_number(double value);

}  // namespace sepcal::simulation
