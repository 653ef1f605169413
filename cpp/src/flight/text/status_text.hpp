// SPDX-License-Identifier: BSD-3-Clause
// What a page says first: the status of the fit, the parameters at their bounds, the message.
#pragma once

#include <string>
#include <vector>

#include "sepcal/fit.hpp"

namespace sepcal::text {

/// "status: converged, 2 parameters at their bounds: alpha_xz, eta_y", then the message.
std::string status_line(FitStatus status, const std::vector<std::string>& at_bound,
                        const std::string& message);
std::string status_line(const Fit& fit);

}  // namespace sepcal::text
