// SPDX-License-Identifier: BSD-3-Clause
// A scan over a parameter that the cost does not depend on smoothly: the time of a step.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal::estimation {

/// Where a scan looks from.
struct ScanPoint {
  std::map<std::string, double> values;  // of the model's parameters; zero where not named
  std::map<std::string, double> held;    // these stay at their value
  int threads = 0;
};

/// The candidate of `parameter` that leaves the least unexplained, all outputs together, once the
/// other parameters follow to first order: coefficients may be linear or not, and zero. Throws
/// Error for a name that is no parameter and where the model is not finite at any candidate.
double scan(const BlockModel& model, const Record& record, const ScanPoint& point,
            const std::string& parameter, const std::vector<double>& candidates);

/// The time between two rows of one segment at which a step explains most: first among 200 spread
/// over the record, then among all about the best one. `parameter` is the step's time, `within` its
/// bounds. Throws Error also where no such time is within the bounds.
double scan_step(const BlockModel& model, const Record& record, const ScanPoint& point,
                 const std::string& parameter, const Interval& within = {});

}  // namespace sepcal::estimation
