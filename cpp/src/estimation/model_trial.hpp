// SPDX-License-Identifier: BSD-3-Clause
// check_model() on rows that stand ready.
#pragma once

#include <map>
#include <string>

#include "model/measurements.hpp"
#include "sepcal/detail/block_model.hpp"

namespace sepcal::estimation {

/// As check_model(); `measurements` are the model's.
void try_model(const BlockModel& model, const model::Measurements& measurements,
               const std::map<std::string, double>& start);

}  // namespace sepcal::estimation
