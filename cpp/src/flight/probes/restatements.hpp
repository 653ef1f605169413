// SPDX-License-Identifier: BSD-3-Clause
// A fit's estimates as people elsewhere write them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "sepcal/fit.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::probes {

/// The wind of parameters w_n and w_e [m/s], where it blows from and how fast, with the ellipse
/// that holds it in 95 %; nothing where both were held.
std::optional<Restatement> restate_wind(const Fit& fit);

/// h = A (m - b) of m = C h + b: A row by row, b [uT], and h in body axes. Nothing where C has no
/// inverse.
std::optional<Restatement> restate_correction(const Eigen::Matrix3d& C, const Eigen::Vector3d& b);

/// How a sensor is turned, by roll, pitch and yaw [deg].
Restatement restate_mounting(const std::array<double, 3>& angles);

/// ArduPilot's ratio, which holds a scale alone, for a tube whose reading V is corrected to
/// (1 + lambda) V + bias.
Restatement restate_ratio(double lambda, double bias);

}  // namespace sepcal::probes
