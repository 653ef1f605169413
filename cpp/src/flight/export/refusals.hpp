// SPDX-License-Identifier: BSD-3-Clause
// What can't be exported as it was asked for, said before any work.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/export.hpp"

namespace sepcal::exporting {

bool is_header(ExportTarget target);

/// Of a joint calibration what holds of one flight, which must be given; another one as it is.
/// Throws Error where what is asked would be fitted to that flight alone.
Calibration of_one_flight(const Calibration& calibration, const Flight* flight,
                          const ExportOptions& options);

/// Throws Error for an effect that the calibration doesn't have.
void check_without(const Calibration& calibration, const std::vector<std::string>& names);

/// Throws Error for an autopilot that holds nothing of it, as of a five-hole probe.
void refuse_homeless(const Calibration& calibration, const ExportOptions& options);

/// Throws Error for a power that a float can't hold over what the driver did on the flight.
void refuse_overflow(const Calibration& calibration);

/// Throws Error for an option that does nothing here.
void refuse_idle(const Calibration& calibration, const ExportOptions& options);

}  // namespace sepcal::exporting
