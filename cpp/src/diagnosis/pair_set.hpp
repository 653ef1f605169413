// SPDX-License-Identifier: BSD-3-Clause
// Two causes at once: a channel that goes with both may pass for them, and a flight seldom says
// which two they are. What it does say is the set of pairs that explain it as well as anything.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/bench.hpp"

namespace sepcal::diagnosis {

/// Two effects as one candidate: "wind[time]+bias_step".
struct Pair {
  std::string name;
  double shape = not_a_number;  // where one of the two was scanned
};

/// Pairs of the surest trials, best first, whose Schwarz criterion is within 9.2 of the least that
/// a single trial or a pair has in this noise; by one step from the fit.
std::vector<Pair> find_pair_set(const Bench& bench, const Trials& trials,
                                const NoiseMembers& noise);

}  // namespace sepcal::diagnosis
