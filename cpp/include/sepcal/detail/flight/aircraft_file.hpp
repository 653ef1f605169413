// SPDX-License-Identifier: BSD-3-Clause
// An aircraft as JSON: {"area_m2", "chord_m", "span_m", "mass_kg", "inertia_kgm2" [Ix, Iy, Iz,
// Ixz], "cg_m", "imu_m", "vane_m" [x, y, z], "rate_reference" "c/V" or "c/2V"}. The inertia may be
// left out where only forces are asked for, and positions where all are the same.
#pragma once

#include <string>
#include <string_view>

#include "sepcal/aircraft/geometry.hpp"

namespace sepcal {

/// Throws Error, opened by `source`, for text that is no such object, for an entry that is unknown,
/// missing or of another kind, and as check_geometry() does.
AircraftGeometry parse_aircraft(std::string_view json, const std::string& source);

/// Throws Error as parse_aircraft() does, and where the file can't be read.
AircraftGeometry read_aircraft(const std::string& file);

std::string to_json(const AircraftGeometry& geometry);

}  // namespace sepcal
