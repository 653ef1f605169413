// SPDX-License-Identifier: BSD-3-Clause
// The `options` of a calibration's JSON: every option of its fit, so that later verbs need no more.
#pragma once

#include <memory>
#include <string>

#include "flight/json/output_values.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::json {

/// The probe's settings and the fit's options, one object.
Json write_options(const Calibration& calibration);

/// The fit's options alone.
Json write_options(const CalibrationOptions& options);

/// How a model with a state is laid along a record.
Json write_trajectory(const TrajectoryOptions& along);

/// Throw Error or Json::exception for an object that write_options() did not write.
CalibrationOptions read_options(const Json& options);
std::shared_ptr<const Probe> read_probe(const std::string& model, const Json& options);

}  // namespace sepcal::json
