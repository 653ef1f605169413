// SPDX-License-Identifier: BSD-3-Clause
// What was sampled: columns held from row to row, interpolated, or on coarse steps.
#pragma once

#include "flight/checks/log.hpp"

namespace sepcal::checks {

void check_samples(const Log& log, std::vector<LogNote>& notes);

/// The columns that are sampled in fewest rows, of those that a fit measures by; none where each
/// row is a sample, or where too few would be left. Asked are velocities over the ground, air data
/// and magnetometers: other columns stand still in level flight, or change as slowly as a density.
std::vector<std::string> find_slowest(const Log& log);

}  // namespace sepcal::checks
