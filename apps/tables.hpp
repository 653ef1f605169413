// SPDX-License-Identifier: BSD-3-Clause
// Results as text for people, and the JSON of the verbs that the library has no type for.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal::app {

std::string calibration_table(const Calibration& calibration);

/// The chain of added effects, each with the error before and after; empty where none was added.
std::string history_table(const Calibration& calibration);

std::string comparison_table(const Comparison& comparison, const Calibration& calibration);

std::string applied_text(const Applied& applied, const Calibration& calibration,
                         const std::string& output);
std::string applied_json(const Applied& applied, const Calibration& calibration,
                         const std::string& output);

std::string effects_table(const std::string& model);
std::string effects_json(const std::vector<std::string>& models);

}  // namespace sepcal::app
