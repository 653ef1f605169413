// SPDX-License-Identifier: BSD-3-Clause
// What the motion leaves untold: headings and airspeeds that were not flown, parts of the sphere
// that were not turned to, rows at rest.
#pragma once

#include "flight/checks/motion.hpp"

namespace sepcal::checks {

void check_excitation(const Log& log, const Settings& settings, std::vector<LogNote>& notes);

/// A turn less the widest arc [rad] that none of the directions [rad] lies in.
double covered_arc(std::vector<double> directions);

/// Share of the sphere within ten degrees of one of the directions (3 x N, of any length), or, of
/// few of them, within what lets N caps cover four spheres: r with (1 - cos r) / 2 = 4 / N.
double covered_sphere(const Eigen::Matrix3Xd& directions);

}  // namespace sepcal::checks
