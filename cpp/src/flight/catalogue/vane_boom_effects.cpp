// SPDX-License-Identifier: BSD-3-Clause
// The effects on a boom with two vanes and a Pitot tube. x is a driver about its centre, s a
// coefficient, v the airspeed as read and V the corrected one, T the temperature.
#include <cmath>

#include "flight/catalogue/effect_makers.hpp"
#include "flight/catalogue/flow_angle_rows.hpp"

namespace sepcal::catalogue {
namespace {

std::string_view airspeed_of_boom(Record& /*record*/) { return "airspeed"; }

std::function<double(std::size_t)> impact_on_boom(const Record& record) {
  return [airspeed = record.column("airspeed"), rho = record.column("rho")](std::size_t row) {
    return 0.5 * rho[row] * airspeed[row] * airspeed[row];
  };
}

/// Of a flank angle beta.
double lost_in_the_tube(double alpha, double beta) {
  const double up = std::tan(alpha);
  const double side = std::tan(beta);
  const double across = up * up + side * side;
  return across / (1.0 + across);
}

/// The vanes' own axis of time: apart from the tube's.
EffectRow vane_lag_row(const std::vector<std::string>& vanes) {
  return {.entry = CataloguedEffect{"vane_lag", "tau da/dt + a = a0 on both vanes", "none", "s"},
          .sentence = "the vanes follow the flow slowly",
          .channels = {"time"},
          .maker = in_time(Delay::Kind::inputs_lagging, longest_probe_lag, vanes),
          .plausible = {{"tau", {0.0, longest_probe_lag}}}};
}

EffectRow vane_time_offset_row(const std::vector<std::string>& vanes) {
  return {.entry = CataloguedEffect{"vane_time_offset", "both vanes late by tau", "none", "s"},
          .sentence = "the vanes' time is late",
          .channels = {"time"},
          .maker = in_time(Delay::Kind::inputs_late, longest_offset, vanes)};
}

}  // namespace

EffectTable vane_boom_effects() {
  const FlowPorts ports = flow_ports();
  const std::vector<std::string> readings{"airspeed", "alpha", "beta", "rho"};
  const std::vector<std::string> vanes{"alpha", "beta"};
  EffectTable table;
  table.ports =
      flow_port_rows(ports, {{any_driver, "v from rho v^2 / 2 + s x, angles as read"},
                             {"throttle", "propwash: v from rho v^2 / 2 + s T", "throttle"}});
  table.effects = {
      heading_bias_row(),
      late_probe_row(readings),
      drifting_probe_row(readings),
      vane_lag_row(vanes),
      vane_time_offset_row(vanes),
      {.entry = CataloguedEffect{"pneumatic_lag", "tau dv/dt + v = v0", "none", "s"},
       .sentence = "the pressures lag in their tubes",
       .channels = {"time"},
       .maker = in_time(Delay::Kind::inputs_lagging, longest_probe_lag, {"airspeed"}),
       .plausible = {{"tau", {0.0, longest_probe_lag}}}},
      lever_arm_row(),
      density_error_row("V + s v / 2T: the temperature is off by s", ports.airspeed_scale),
      compressibility_row(ports, impact_on_boom),
      angle_loss_row(ports, "pressure loss: V + s sin^2(flow's angle) v", lost_in_the_tube),
      upwash_row(ports, airspeed_of_boom, {"q"}),
      sidewash_row(ports, airspeed_of_boom, {"p"}),
      pressure_zero_row("v from rho v^2 / 2 + s, angles as read"),
      icing_ramp_row("V + s (t - t0)+ v, t0 fitted", ports.airspeed_scale),
      water_blockage_row("V + s v from t0 on, t0 by a scan", ports.airspeed_scale),
      mounting_error_row()};
  add_flow_surroundings(table);
  table.disturbed = {"airspeed", "alpha", "beta"};
  return table;
}

}  // namespace sepcal::catalogue
