// SPDX-License-Identifier: BSD-3-Clause
// What an autopilot holds as its own parameters, and these as the text of a file.
#pragma once

#include <string>
#include <vector>

#include "flight/export/held.hpp"
#include "flight/export/held_airspeed.hpp"

namespace sepcal::exporting {

/// A COMPASS_SCALE outside these is ignored by ArduPilot.
inline constexpr double largest_compass_scale = 1.5;
inline constexpr double least_compass_scale = 1.0 / largest_compass_scale;

/// COMPASS_SCALE: trace(W) / 3, or one where that would be ignored, and COMPASS_DIA and ODI hold
/// all of W.
double compass_scale(const HeldField& held);

/// 1 to 3: COMPASS_OFS_X, COMPASS_OFS2_X, COMPASS_OFS3_X. Throws Error for another sensor.
std::vector<VehicleParameter> ardupilot_compass(const HeldField& held,
                                                const ExportOptions& options);

/// 1 or 2: ARSPD_RATIO, ARSPD2_RATIO.
std::vector<VehicleParameter> ardupilot_airspeed(const HeldAirspeed& held, const TubeReader& reader,
                                                 const ExportOptions& options);

/// 0 to 3: CAL_MAG0_XOFF. R is the mounting, which CAL_MAG0_ROT numbers or says to be custom.
std::vector<VehicleParameter> px4_magnetometer(const HeldField& held, const ExportOptions& options);

/// 1 to 3: ASPD_SCALE_1. SENS_DPRES_OFF is every sensor's.
std::vector<VehicleParameter> px4_airspeed(const HeldAirspeed& held, const ExportOptions& options);

/// The file, `comment` a line each at its head; numbers are those of a float.
std::string ardupilot_text(const std::vector<VehicleParameter>& parameters,
                           const std::vector<std::string>& comment);
std::string px4_text(const std::vector<VehicleParameter>& parameters,
                     const std::vector<std::string>& comment);

/// Throws Error where a value is none or lies outside what the autopilot takes.
void check_range(const VehicleParameter& parameter, double lowest, double highest);

/// The sensor that is asked for, or the first. Throws Error outside [first, last].
int sensor_of(const ExportOptions& options, int first, int last, std::string_view what);

/// A number as a float holds it, zero without a sign.
std::string float_text(double value);

inline constexpr double sea_level_density = 1.225;  // kg/m^3, of both autopilots
inline constexpr double plain_ratio = 2.0 / sea_level_density;

/// ARSPD_RATIO of a perfect tube: an SDP3x's driver hands on its pressure over sea_level_density.
constexpr double plain_ratio_of(bool sdp3x) { return sdp3x ? 2.0 : plain_ratio; }

}  // namespace sepcal::exporting
