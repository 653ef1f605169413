// SPDX-License-Identifier: BSD-3-Clause
// The effects on a pitot-static tube, where they act before its own scale and bias. x is a driver
// about its centre, s a coefficient, V the true airspeed and V_met the one that the tube meets.
#include "flight/catalogue/air_data_rows.hpp"
#include "flight/catalogue/effect_makers.hpp"

namespace sepcal::catalogue {

EffectTable pitot_static_effects() {
  const Port airspeed_scale = on_input("airspeed_scale", "1", largest_scale);
  const Port airspeed_bias = on_input("airspeed_bias", "m/s", largest_speed);
  EffectTable table;
  table.ports = {wind_row({{.name = "n", .input = "vn", .sign = -1.0},
                           {.name = "e", .input = "ve", .sign = -1.0}},
                          largest_wind),
                 airspeed_scale_row(airspeed_scale, {{any_driver, "V = V_met + s x V_met"}}),
                 airspeed_bias_row(airspeed_bias, {{any_driver, "V = V_met + s x"}}),
                 pressure_offset_row({{any_driver, "rho V^2 / 2 = rho V_met^2 / 2 + s x",
                                       "any DRIVER, and density"}})};
  table.effects = {
      {.entry = CataloguedEffect{"time_offset", "airspeed late by tau", "none", "s"},
       .sentence = "the sensor's time is late",
       .channels = {"time"},
       .maker = in_time(Delay::Kind::outputs_late, longest_offset)},
      {.entry = CataloguedEffect{"clock_drift", "airspeed late, from 0 at first to tau at last",
                                 "none", "s"},
       .sentence = "the sensor's clock drifts",
       .channels = {"time"},
       .maker = drifting_clock(Delay::Kind::outputs_late, longest_offset)},
      {.entry = CataloguedEffect{"pneumatic_lag", "tau dz/dt + z = z0", "none", "s"},
       .sentence = "the pressures lag in their tubes",
       .channels = {"time"},
       .maker = in_time(Delay::Kind::outputs_lagging, longest_sensor_lag),
       .plausible = {{"tau", {0.0, longest_sensor_lag}}}},
      density_error_row("V = V_met + s V_met / 2T: the temperature is off by s", airspeed_scale),
      pressure_zero_row("rho V^2 / 2 = rho V_met^2 / 2 + s"),
      icing_ramp_row("V = V_met + s (t - t0)+ V_met, t0 fitted", airspeed_scale),
      water_blockage_row("V = V_met + s V_met from t0 on, t0 by a scan", airspeed_scale)};
  table.aliases = air_data_aliases("throttle, density");
  table.channels = air_data_channels();
  table.error_budget = {velocity_bound(), gust_bound(), airspeed_bound()};
  table.error_budget[0].port = table.error_budget[1].port = "wind";
  table.error_budget[2].outputs = {"airspeed"};
  return table;
}

}  // namespace sepcal::catalogue
