// SPDX-License-Identifier: BSD-3-Clause
// The effects on a magnetometer without attitude: those that show in the strength of the field. x
// is a driver about its centre, s a coefficient, h the true field in body axes, C the sensor's
// matrix.
#include "flight/catalogue/effect_makers.hpp"
#include "flight/catalogue/magnetic_rows.hpp"

namespace sepcal::catalogue {
EffectTable attitude_independent_effects() {
  Port bias{"bias", "uT", {}, largest_field};
  Port axis_scale{"axis_scale", "1", {}, largest_scale};
  for (const char* axis : axes) {
    bias.components.push_back({.name = axis, .input = std::string("m").append(axis), .sign = -1.0});
    axis_scale.components.push_back(
        {.name = axis, .input = std::string("axis_scale_").append(axis)});
  }
  const Port scale{"scale", "1", {{.name = "s", .input = "scale"}}, largest_scale};
  EffectTable table;
  table.ports = {bias_row(bias), scale_row(scale, "(C + s x I) h"),
                 axis_scale_row(axis_scale, "(C + diag(s_i x)) h (x, y, z)")};
  table.effects = {bias_step_row(bias), warm_up_row(bias)};
  table.aliases = magnetic_aliases();
  table.channels = magnetic_channels();
  table.error_budget = {field_bound({"field"})};
  return table;
}

}  // namespace sepcal::catalogue
