// SPDX-License-Identifier: BSD-3-Clause
// What a person must do beside loading the parameters, and what was dropped, in words.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flight/export/kept_field.hpp"
#include "flight/export/tube_reader.hpp"

namespace sepcal::exporting {

/// "PX4's magnetometer 0".
std::string vehicle_title(const Calibration& calibration, const ExportOptions& options);

/// A sentence a line, of what `exported` holds of the calibration that was given. `mounting`: how
/// the vehicle is to turn the sensor, where anyone said.
std::vector<std::string> field_notes(const Calibration& given, const Exported& exported,
                                     const ExportOptions& options,
                                     const std::optional<VehicleMounting>& mounting);
std::vector<std::string> airspeed_notes(const ChosenTubeReader& chosen,
                                        const ExportOptions& options);

/// Add what a vehicle can't hold to the approximation.
void drop_rotation(bool is_known, Approximation& approximation);
void drop_bias(const Calibration& full, const HeldAirspeed& held, const TubeReader& reader,
               Approximation& approximation);

}  // namespace sepcal::exporting
