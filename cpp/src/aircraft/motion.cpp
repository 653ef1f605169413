// SPDX-License-Identifier: BSD-3-Clause
#include "aircraft/motion.hpp"

#include <algorithm>
#include <cmath>

#include "base/short_number.hpp"
#include "numerics/local_cubic.hpp"
#include "numerics/order_statistics.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/flight_path.hpp"

namespace sepcal::aircraft {
namespace {

using Eigen::Vector3d;
using ThreeNames = std::array<std::string_view, 3>;

constexpr ThreeNames accelerations{"ax", "ay", "az"};
constexpr ThreeNames body_rates{"p", "q", "r"};
constexpr ThreeNames derivatives{"pdot", "qdot", "rdot"};
constexpr std::size_t rows_of_cubic = 5;
constexpr std::size_t usual_rows = 7;

double middle_of(std::vector<double> values) {
  std::ranges::sort(values);
  return numerics::quantile(values, 0.5);
}

bool has_all(const Record& record, const ThreeNames& names) {
  return std::ranges::all_of(names, [&](std::string_view name) { return record.has(name); });
}

void need(const Record& record, std::string_view name, const std::string& whose,
          const std::string& way_out) {
  if (record.has(name)) return;
  throw Error("column '" + std::string(name) + "' is missing, which " + whose + " needs; " +
              way_out);
}

bool is_force(const std::string& coefficient) {
  return coefficient.starts_with('C') && std::isupper(coefficient[1]) != 0;
}

void need_rates(const Record& record, const std::string& whose, const std::string& way_out) {
  for (const std::string_view name : body_rates) {
    need(record, name, whose,
         "add it (zeros where the maneuver keeps to the plane of symmetry), or " + way_out);
  }
  if (!has_all(record, derivatives)) {
    need(record, "time", whose, "add it, s, or pdot, qdot and rdot, rad/s^2");
  }
}

void check_coefficient(const Record& record, const AircraftGeometry& geometry,
                       const std::string& name) {
  if (is_force(name)) {
    const auto axis = static_cast<std::size_t>(name[1] - 'X');
    need(record, accelerations[axis], name,
         "add it, m/s^2, a specific force: level flight reads az = -9.81; or leave " + name +
             " out");
    return;
  }
  if (!geometry.has_inertia()) {
    throw Error(name +
                " needs the aircraft's inertia; give Ix, Iy, Iz and Ixz, or leave the "
                "moments out and ask for CX, CY, CZ");
  }
  need_rates(record, name, "leave the moments out and ask for CX, CY, CZ");
}

void check_surfaces(const Record& record) {
  constexpr double largest_deflection = 2.0;  // rad
  for (const char* name : {"elevator", "aileron", "rudder"}) {
    if (!record.has(name)) continue;
    for (const double value : record.column(name)) {
      if (!(std::abs(value) > largest_deflection)) continue;
      throw Error("'" + std::string(name) + "' reaches " + base::short_number(value) +
                  " rad; it is probably in degrees: convert it");
    }
  }
}

/// Throws Error where there is such a column with a value that is not above zero, or not finite.
void check_positive(const Record& record, const std::string& name, bool may_lack) {
  if (!record.has(name)) return;
  const std::span<const double> values = record.column(name);
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      if (values[row] > 0.0 && std::isfinite(values[row])) continue;
      if (may_lack && std::isnan(values[row])) continue;
      throw Error(name + " is " + base::short_number(values[row]) + " in row " +
                  std::to_string(row) +
                  " (counted from 0); coefficients need it above zero: leave such rows out");
    }
  }
}

/// What the coefficients are made of.
void check_flow(const Record& record, bool forces) {
  check_positive(record, "airspeed", false);
  check_positive(record, record.has("qbar") ? "qbar" : "rho", true);
  if (forces) check_positive(record, "mass", true);
}

void check_window(double window) {
  if (window >= 0.0 && std::isfinite(window)) return;
  throw Error("window is " + base::short_number(window) +
              "; it is a time above 0, s, or 0 for seven rows");
}

double seven_rows(const Record& record) {
  std::vector<double> steps;
  for (const Segment& segment : record.segments()) {
    const auto time = record.column("time").subspan(segment.first, segment.rows());
    for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  }
  if (steps.empty()) return not_a_number;
  return static_cast<double>(usual_rows - 1) * middle_of(std::move(steps));
}

}  // namespace

Channels::Channels(const Record& record, const AircraftGeometry& geometry,
                   const std::vector<std::string>& coefficients, double window)
    : record_(record),
      geometry_(geometry),
      imu_(geometry.imu - geometry.cg),
      vane_(geometry.vane - geometry.cg) {
  check_body_axes(record);
  check_surfaces(record);
  check_window(window);
  need(record, "airspeed", "every coefficient", "add it, m/s");
  if (!record.has("qbar")) {
    need(record, "rho", "the dynamic pressure", "add it, kg/m^3, or qbar, Pa");
  }
  for (const std::string& name : coefficients) check_coefficient(record, geometry, name);
  const bool forces = std::ranges::any_of(coefficients, is_force);
  check_flow(record, forces);
  const bool moments = !std::ranges::all_of(coefficients, is_force);
  const bool levers = !imu_.isZero() && forces;
  if (levers) {
    for (const std::string_view name : accelerations) {
      need(record, name, "the inertial unit's lever arm", "add it, or put imu where cg is");
    }
    need_rates(record, "the inertial unit's lever arm", "put imu where cg is");
  }
  if (!vane_.isZero()) {
    for (const std::string_view name : {"p", "q", "r", "alpha", "beta"}) {
      need(record, name, "the vane's lever arm", "add it, or put vane where cg is");
    }
  }
  if ((moments || levers) && !has_all(record, derivatives)) differentiate(window);
}

void Channels::differentiate(double window) {
  window_ = window > 0.0 ? window : seven_rows(record_);
  for (auto& slopes : slopes_) slopes.assign(record_.length(), not_a_number);
  for (const Segment& segment : record_.segments()) {
    const auto time = record_.column("time").subspan(segment.first, segment.rows());
    const std::size_t fewest = numerics::fewest_rows(time, window_);
    if (segment.rows() < rows_of_cubic) {
      const std::string label = segment.label.empty() ? "" : " '" + segment.label + "'";
      throw Error("the segment" + label + " has " + std::to_string(segment.rows()) +
                  " rows, and rates are differentiated over 5 at least; leave it out");
    }
    if (fewest < rows_of_cubic) {
      throw Error("a window of " + base::short_number(window_) + " s holds " +
                  std::to_string(fewest) +
                  " rows somewhere, and a local cubic needs 5; choose a longer window, or leave "
                  "short segments out");
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const auto rate = record_.column(body_rates[i]).subspan(segment.first, segment.rows());
      std::ranges::copy(numerics::differentiate_locally(time, rate, window_),
                        slopes_[i].begin() + static_cast<std::ptrdiff_t>(segment.first));
    }
  }
}

double Channels::read(std::string_view name, std::size_t row) const {
  return record_.has(name) ? record_.column(name)[row] : not_a_number;
}

Vector3d Channels::read(const ThreeNames& names, std::size_t row) const {
  return {read(names[0], row), read(names[1], row), read(names[2], row)};
}

Motion Channels::at(std::size_t row) const {
  Motion at{.acceleration = read(accelerations, row),
            .rates = read(body_rates, row),
            .rates_dot = read(derivatives, row),
            .airspeed = read("airspeed", row),
            .alpha = read("alpha", row),
            .beta = read("beta", row),
            .qbar = read("qbar", row),
            .mass = record_.has("mass") ? read("mass", row) : geometry_.mass,
            .thrust = record_.has("thrust") ? read("thrust", row) : 0.0};
  if (differentiates()) {
    for (std::size_t i = 0; i < 3; ++i)
      at.rates_dot[static_cast<Eigen::Index>(i)] = slopes_[i][row];
  }
  if (!imu_.isZero()) {
    at.acceleration -= at.rates_dot.cross(imu_) + at.rates.cross(at.rates.cross(imu_));
  }
  if (!vane_.isZero()) {
    const Vector3d air =
        at.airspeed * Vector3d(std::cos(at.alpha) * std::cos(at.beta), std::sin(at.beta),
                               std::sin(at.alpha) * std::cos(at.beta)) -
        at.rates.cross(vane_);
    at.airspeed = air.norm();
    at.alpha = std::atan2(air[2], air[0]);
    at.beta = std::asin(air[1] / at.airspeed);
  }
  if (std::isnan(at.qbar)) at.qbar = 0.5 * read("rho", row) * at.airspeed * at.airspeed;
  return at;
}

}  // namespace sepcal::aircraft
