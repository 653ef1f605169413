// SPDX-License-Identifier: BSD-3-Clause
// What a calibration found beside its parameters, as JSON: derived quantities, the history of added
// effects, combinations that are not or hardly determined. Readers throw as nlohmann::json does.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "flight/json/output_values.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::json {

std::vector<Derived> read_derived(const Json& object);

Json write_restated(const std::vector<Restatement>& restated);
std::vector<Restatement> read_restated(const Json& object);

Json write_ranges(const std::map<std::string, Interval>& ranges);
std::map<std::string, Interval> read_ranges(const Json& object);

std::vector<HistoryEntry> read_history(const Json& list);

Json write_combinations(const std::vector<Combination>& combinations);
std::vector<Combination> read_combinations(const Json& list);

}  // namespace sepcal::json
