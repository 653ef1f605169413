// SPDX-License-Identifier: BSD-3-Clause
// The six aerodynamic coefficients that a flight had, from what its inertial unit read: forces from
// accelerations moved to the centre of gravity, moments by Euler's equations (S 6.14 to 6.19).
//   CX = (m ax - T)/(qbar S),  CY = m ay/(qbar S),  CZ = m az/(qbar S),
//   Cl = [Ix p' - Ixz (r' + p q) + (Iz - Iy) q r]/(qbar S b),
//   Cm = [Iy q' + (Ix - Iz) p r + Ixz (p^2 - r^2)]/(qbar S c),
//   Cn = [Iz r' - Ixz (p' - q r) + (Iy - Ix) p q]/(qbar S b)
#pragma once

#include <string>
#include <vector>

#include "sepcal/aircraft/geometry.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

struct CoefficientOptions {
  /// Which to compute, of CX ... Cn; empty: all six.
  std::vector<std::string> coefficients = {};
  /// Of the local cubic that differentiates p, q and r, s; 0: seven rows.
  double window = 0.0;
};

struct AeroCoefficients {
  /// The record's columns and segments; airspeed, alpha and beta moved to the centre of gravity;
  /// beside them the coefficients and, where there are rates, p_hat, q_hat, r_hat and pdot, qdot,
  /// rdot, rad/s^2. NaN outside the segments.
  Record record;
  std::vector<std::string> names;  // of the coefficients that were computed
  double window = not_a_number;    // of the local cubic, s; NaN where the record has pdot qdot rdot
  /// coefficient_notes(), and over what rates were differentiated, a sentence each.
  std::vector<std::string> notes;
};

/// What must be known to read coefficients or parameters: "q_hat is q c/2V, ...", and that CX
/// holds the thrust where it is among them and the record has no `thrust`.
std::vector<std::string> coefficient_notes(const Record& record, const AircraftGeometry& geometry,
                                           const std::vector<std::string>& coefficients);

/// Columns, SI: `time`; `ax ay az`, specific forces at geometry.imu: level flight reads az = -9.81;
/// `p q r`; `airspeed`, `alpha`, `beta` at geometry.vane; `rho` or `qbar`. Where there are:
/// `thrust` along the axis forward, N; `mass`, kg, in place of the geometry's; `pdot qdot rdot`,
/// rad/s^2. Only what the chosen coefficients need is asked for. Throws Error for what is missing,
/// with the way out, for degrees, and for a vertical acceleration that is no specific force.
AeroCoefficients aero_coefficients(const Record& record, const AircraftGeometry& geometry,
                                   const CoefficientOptions& options = {});

}  // namespace sepcal
