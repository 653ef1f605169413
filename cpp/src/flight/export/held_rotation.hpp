// SPDX-License-Identifier: BSD-3-Clause
// Which symmetric matrix an autopilot gets of a magnetometer that the calibration turns too.
#pragma once

#include <optional>
#include <string>

#include "flight/export/kept_field.hpp"

namespace sepcal::exporting {

/// Of a fit that the vehicle is to load, in check_fit_for_use()'s messages.
inline constexpr const char* held_by_autopilot = "what the autopilot can hold of the calibration";

/// A calibration that an autopilot is to hold.
struct ToHold {
  const Calibration& given;        // which it is compared with
  const Calibration& base;         // without the effects that are left out
  const Flight* flight = nullptr;  // none: what is lost is not known
  bool of_several = false;         // flights jointly, so that none is fitted anew
  std::optional<VehicleMounting> mounting = {};
};

/// What the autopilot holds into `held`; returns what that loses. Sets the rotation, the other
/// one's approximation and notes of `exported`. Throws Error where a refit is asked for and is not
/// fit to be used.
Approximation hold_field(const ToHold& field, const ExportOptions& options, Calibration& held,
                         Exported& exported);

}  // namespace sepcal::exporting
