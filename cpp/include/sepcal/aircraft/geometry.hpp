// SPDX-License-Identifier: BSD-3-Clause
// What an aircraft is to its equations of motion: dimensions, mass, inertia, and where its sensors
// sit. A value; flight/aircraft_file.hpp reads it from JSON.
#pragma once

#include <Eigen/Core>
#include <string_view>

#include "sepcal/detail/quantity.hpp"

namespace sepcal {

/// What makes the pitch rate a number, q_hat: q c/V as S 6.8 to 6.13 print it, or q c/(2V), as most
/// of the literature has it. CX_q, CZ_q and Cm_q of the first are half those of the second. Roll
/// and yaw rates are p b/(2V) and r b/(2V) in both.
enum class RateReference { chord_per_speed, chord_per_twice_speed };

/// "c/V", "c/2V".
std::string_view to_string(RateReference reference);

/// The reference of that name. Throws Error listing the names.
RateReference find_rate_reference(std::string_view name);

/// About the centre of gravity, body axes forward, right, down, kg m^2. Ixz is the integral of x z
/// dm: the matrix has -Ixz beside its diagonal.
struct Inertia {
  double Ix = not_a_number;
  double Iy = not_a_number;
  double Iz = not_a_number;
  double Ixz = 0.0;
};

/// Positions are in body axes, forward, right, down, from any one point of the aircraft.
struct AircraftGeometry {
  double area = not_a_number;                      // wing, m^2
  double chord = not_a_number;                     // mean aerodynamic, m
  double span = not_a_number;                      // m
  double mass = not_a_number;                      // kg
  Inertia inertia = {};                            // unknown where only forces are asked for
  Eigen::Vector3d cg = Eigen::Vector3d::Zero();    // centre of gravity, m
  Eigen::Vector3d imu = Eigen::Vector3d::Zero();   // inertial unit, m
  Eigen::Vector3d vane = Eigen::Vector3d::Zero();  // where airspeed, alpha and beta are read, m
  RateReference rate_reference = RateReference::chord_per_twice_speed;

  bool has_inertia() const;
};

/// Throws Error for an aircraft that can't be: an area, length or mass that is not above zero, a
/// chord longer than the span, an inertia that no body has.
void check_geometry(const AircraftGeometry& geometry);

}  // namespace sepcal
