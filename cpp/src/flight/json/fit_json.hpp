// SPDX-License-Identifier: BSD-3-Clause
// A fit and the flight that it was fitted to, as JSON: what calibrations of sensors and fits of
// aircraft have in common. Readers throw Error or as nlohmann::json does.
#pragma once

#include <string>
#include <vector>

#include "flight/json/output_values.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::json {

Json write_inputs(const FittedFlight& flight);
FittedFlight read_inputs(const Json& inputs);

/// status, message, parameters.
void write_estimates(const Fit& fit, Json& root);

/// correlation, unobservable, weak, cost, rmse, noise, iterations, stage_one, stage_two.
void write_rest(const Fit& fit, const FitOptions& options, Json& root);

/// What both wrote; `outputs` in the order of the model's table. Rows are not in it.
Fit read_fit(const Json& root, const CalibrationOptions& options,
             const std::vector<std::string>& outputs);

}  // namespace sepcal::json
