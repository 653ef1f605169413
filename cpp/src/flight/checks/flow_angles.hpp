// SPDX-License-Identifier: BSD-3-Clause
// Flow angles that run against the motion: a port or a vane with the other sign.
#pragma once

#include <vector>

#include "flight/checks/log.hpp"
#include "flight/checks/motion.hpp"
#include "sepcal/flight/check.hpp"

namespace sepcal::checks {

/// Of a probe with flow angles, attitude and velocity: V = W + R V_s (1, b_b + s_b beta, b_a + s_a
/// alpha), linear in a wind W, biases and scales, which tells the sign of each angle whatever the
/// wind. One that comes out negative by far more than the rows leave open is noted.
void check_flow_angles(const Log& log, const Settings& settings, std::vector<LogNote>& notes);

}  // namespace sepcal::checks
