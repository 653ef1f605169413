// SPDX-License-Identifier: BSD-3-Clause
// What the tables of probes have in common that read flow angles and are measured against the
// velocity over the ground. v is the airspeed as read, V the corrected one, W the wind.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "flight/catalogue/air_data_rows.hpp"

namespace sepcal::catalogue {

inline constexpr double longest_probe_lag = 0.5;  // [s] of pressures in their tubes, of a vane

/// The ports by which all their effects come in.
struct FlowPorts {
  Port airspeed_scale;
  Port airspeed_bias;
  Port alpha_offset;
  Port beta_offset;
};
FlowPorts flow_ports();

/// All of them, wind and pressure_offset too, whose forms are the probe's own.
std::vector<PortRow> flow_port_rows(const FlowPorts& ports,
                                    const std::vector<Form>& of_pressure_offset);

/// The logged heading is off, the lever arm is, the probe is mounted at an angle.
EffectRow heading_bias_row();
EffectRow lever_arm_row();
EffectRow mounting_error_row();

/// The probe's clock is late, or drifts: `inputs` are what it reads.
EffectRow late_probe_row(const std::vector<std::string>& inputs);
EffectRow drifting_probe_row(const std::vector<std::string>& inputs);

/// Gives a record the airspeed as read [m/s] where it has none, and says the column's name.
using AirspeedColumn = std::string_view (*)(Record& record);

/// The pitch rate turns the flow in alpha, the roll rate that in beta: by k times it, over the
/// airspeed as read. `channels` are what a correction reads for it.
EffectRow upwash_row(const FlowPorts& ports, AirspeedColumn airspeed,
                     const std::vector<std::string>& channels);
EffectRow sidewash_row(const FlowPorts& ports, AirspeedColumn airspeed,
                       const std::vector<std::string>& channels);

/// The impact pressure [Pa] of a record's rows.
using ImpactPressure = std::function<double(std::size_t row)> (*)(const Record& record);

EffectRow compressibility_row(const FlowPorts& ports, ImpactPressure impact);

/// The Pitot hole loses pressure by the square of the sine of the flow's whole angle, which is
/// `lost` of the angles as read [rad].
EffectRow angle_loss_row(const FlowPorts& ports, const std::string& equation,
                         double (*lost)(double alpha, double beta));

/// Aliases, channels, and the errors that wander.
void add_flow_surroundings(EffectTable& table);

/// Adds a column that an effect derives from others; `value(row)` may be called for every row.
void derive(Record& record, const std::string& name,
            const std::function<double(std::size_t row)>& value);

}  // namespace sepcal::catalogue
