// SPDX-License-Identifier: BSD-3-Clause
// What the tables of all air data probes have in common.
#pragma once

#include <string>
#include <vector>

#include "flight/catalogue/effect_table.hpp"

namespace sepcal::catalogue {

inline constexpr double largest_wind = 200.0;   // [m/s]
inline constexpr double largest_speed = 50.0;   // [m/s] of a bias of the airspeed
inline constexpr double largest_kelvin = 50.0;  // [K] of an error of the temperature

/// A port with the one component s, which is added to the input of that name.
Port on_input(const std::string& name, const std::string& unit, double plausible);

PortRow wind_row(const std::vector<Port::Component>& components, double plausible);
PortRow airspeed_scale_row(const Port& port, const std::vector<Form>& forms);
PortRow airspeed_bias_row(const Port& port, const std::vector<Form>& forms);
PortRow pressure_offset_row(const std::vector<Form>& forms);

/// The pressure's zero is off: a constant on that port.
EffectRow pressure_zero_row(const std::string& equation);

/// The temperature behind the density is off, and with it the airspeed's scale.
EffectRow density_error_row(const std::string& equation, const Port& airspeed_scale);

EffectRow icing_ramp_row(const std::string& equation, const Port& airspeed_scale);
EffectRow water_blockage_row(const std::string& equation, const Port& airspeed_scale);

std::vector<AliasRow> air_data_aliases(const std::string& drivers_of_propwash);

std::vector<Channel> air_data_channels();

/// The half of 1 / T [1/K] of the logged temperature, by which an error of the temperature changes
/// the airspeed.
DriverPointer derive_half_coldness(Record& record);

/// How far errors of satellite and inertial velocities wander, in each component, and gusts of
/// light air over fifteen seconds; where they come in is left to the caller.
ErrorBound velocity_bound();
ErrorBound gust_bound();

/// The same of the airspeed, by its transducer.
ErrorBound airspeed_bound();

}  // namespace sepcal::catalogue
