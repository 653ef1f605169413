// SPDX-License-Identifier: BSD-3-Clause
// What a person must do beside loading the parameters, and what was dropped, in words.
#pragma once

#include <string>
#include <vector>

#include "flight/export/held.hpp"

namespace sepcal::exporting {

/// Whether a tube's reading is a logged airspeed, not a pressure.
bool reads_airspeed(const Calibration& calibration, const Flight& flight);

/// "PX4's magnetometer 0".
std::string vehicle_title(const Calibration& calibration, const ExportOptions& options);

/// A sentence a line. `flight`: that was fitted; nullptr where there is none.
std::vector<std::string> vehicle_notes(const Calibration& calibration, const Flight* flight,
                                       const ExportOptions& options);

/// Add what a vehicle can't hold to the loss.
void drop_rotation(bool is_known, ExportLoss& loss);
void drop_bias(const Calibration& full, const HeldAirspeed& held, ExportLoss& loss);

}  // namespace sepcal::exporting
