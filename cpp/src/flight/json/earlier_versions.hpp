// SPDX-License-Identifier: BSD-3-Clause
// Files of earlier schema versions, made those of the present one.
//   1: `priors` were what samples are drawn from, `knowledge` what regularises the fit
//   2: `stage_one` and `stage_two` were options too, and what stage two was over was its `method`
#pragma once

#include <string>

#include "flight/json/output_values.hpp"

namespace sepcal::json {

/// Converts a calibration, or what fit wrote of an aircraft, of a version that check_version() lets
/// pass. Throws Json::exception where entries are of another kind or lack what they are converted
/// from.
void convert_earlier(Json& root);

/// Throws Error for a version before `first` or later than the present one.
void check_version(const Json& version, int first, const std::string& source);

}  // namespace sepcal::json
