// SPDX-License-Identifier: BSD-3-Clause
// Calibrations of schema version 1, in which `priors` were what samples are drawn from and
// `knowledge` was what regularises the fit.
#pragma once

#include "flight/json/output_values.hpp"

namespace sepcal::json {

/// Makes the options of a calibration of version 1 those of the present one. Throws
/// Json::exception where they are of another kind or lack what they are converted from.
void convert_version_1(Json& options);

}  // namespace sepcal::json
