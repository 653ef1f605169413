// SPDX-License-Identifier: BSD-3-Clause
// What a page says first: the status of the fit, the parameters at their bounds, and the message, a
// sentence a line.
#pragma once

#include <string>
#include <vector>

#include "base/page.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::text {

/// The sentences of a fit's message, the worst first.
std::vector<std::string> sentences(const std::string& message);

/// They, a line each; of a brief page the three worst, each within a line.
base::Page sentence_lines(const std::string& message, Detail detail);

/// "status: converged, 2 parameters at their bounds: alpha_xz, eta_y", then sentence_lines().
base::Page status_lines(FitStatus status, const std::vector<std::string>& at_bound,
                        const std::string& message, Detail detail);
base::Page status_lines(const Fit& fit, Detail detail);

}  // namespace sepcal::text
