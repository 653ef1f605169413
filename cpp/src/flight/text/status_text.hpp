// SPDX-License-Identifier: BSD-3-Clause
// What a page says first: the status of the fit, the parameters at their bounds, and the message, a
// sentence a line.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/calibration.hpp"

namespace sepcal::text {

/// The sentences of a fit's message, the worst first.
std::vector<std::string> sentences(const std::string& message);

/// They, a line each; of a brief page the three worst, each within a line.
std::string sentence_lines(const std::string& message, Detail detail);

/// "status: converged, 2 parameters at their bounds: alpha_xz, eta_y", then sentence_lines().
std::string status_lines(FitStatus status, const std::vector<std::string>& at_bound,
                         const std::string& message, Detail detail);
std::string status_lines(const Fit& fit, Detail detail);

}  // namespace sepcal::text
