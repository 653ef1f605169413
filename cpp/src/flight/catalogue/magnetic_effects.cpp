// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/magnetic_effects.hpp"

#include <array>
#include <utility>

#include "flight/catalogue/effect_makers.hpp"
#include "numerics/interpolated_column.hpp"
#include "sepcal/effects/magnetic.hpp"
#include "sepcal/static_effect.hpp"

namespace sepcal::catalogue {
namespace {

using Component = Port::Component;
using Setting = EffectSetting;

constexpr double largest_field = 500.0;  // [uT] of a bias
constexpr double largest_scale = 0.5;    // [1]
constexpr double longest_offset = 0.5;   // [s]
constexpr double longest_lag = 0.2;      // [s]

constexpr std::array<const char*, 3> axes{"x", "y", "z"};
constexpr std::array<const char*, 3> field{"hx", "hy", "hz"};
constexpr std::array<const char*, 3> field_rate{"hx_dot", "hy_dot", "hz_dot"};

/// dh/dt in body axes: -w x h where the rates are logged, else from the field itself. Nothing where
/// there is no field: who corrects a reading finds both.
void derive_field_rate(Record& record) {
  if (record.has(field_rate[0]) || !record.has(field[0])) return;
  std::array<std::vector<double>, 3> rate;
  for (std::vector<double>& column : rate) column.assign(record.length(), 0.0);
  const auto logged = [&](const char* rate_name) { return is_logged(record, rate_name); };
  if (record.has("r") && (logged("p") || logged("q") || logged("r"))) {
    const std::array w{record.column("p"), record.column("q"), record.column("r")};
    const std::array h{record.column("hx"), record.column("hy"), record.column("hz")};
    for (std::size_t row = 0; row < record.length(); ++row) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t k = (i + 2) % 3;
        rate[i][row] = w[k][row] * h[j][row] - w[j][row] * h[k][row];
      }
    }
  } else {
    for (std::size_t i = 0; i < 3; ++i) {
      const numerics::InterpolatedColumn column(record, field[i]);
      for (const Segment& segment : record.segments()) {
        std::vector<NaturalSpline::Value> values(segment.rows());
        column.fill(segment.first, 0.0, values);
        for (std::size_t n = 0; n < values.size(); ++n) {
          rate[i][segment.first + n] = values[n].slope;
        }
      }
    }
  }
  for (std::size_t i = 0; i < 3; ++i) record.add(field_rate[i], std::move(rate[i]));
}

EffectKit::Maker eddy_currents() {
  return [](const BlockModel& /*model*/, Setting& /*setting*/, Record& record) {
    derive_field_rate(record);
    return effect("eddy_currents", effects::EddyCurrents{});
  };
}

EffectKit::Maker field_declination() {
  return [](const BlockModel& /*model*/, Setting& /*setting*/, Record& record) {
    need_columns("field_declination", record, {"roll", "pitch"});
    return effect("field_declination", effects::FieldDeclination{});
  };
}

void add_switched(EffectKit& kit, const Port& bias) {
  kit.own["bias_step"] = renamed("bias_step", "bias[step(time)]", bias);
  kit.own["warm_up"] = renamed("warm_up", "bias[decay(time)]", bias);
  kit.aliases["bias_drift"] = [](const Record&) { return "bias[time]"; };
}

}  // namespace

EffectKit magnetometer_effects() {
  Port bias{"bias", "uT", {}};
  Port scale{"scale", "1", {Component{.name = "s"}}};
  Port axis_scale{"axis_scale", "1", {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const Varying::Share share{static_cast<int>(i), {field[i], "uT"}};
    bias.components.push_back({.name = axes[i], .linear = std::string("n_") + axes[i]});
    scale.components.front().shares.push_back(share);
    axis_scale.components.push_back({.name = axes[i], .shares = {share}});
  }
  EffectKit kit;
  kit.ports = {bias, scale, axis_scale};
  add_switched(kit, bias);
  kit.own.insert(own_effect("cubic_nonlinearity", effects::CubicNonlinearity{}));
  kit.own["eddy_currents"] = eddy_currents();
  kit.own["time_offset"] = in_time("time_offset", Delay::Kind::outputs_late, longest_offset);
  kit.own["sensor_lag"] = in_time("sensor_lag", Delay::Kind::outputs_lagging, longest_lag);
  kit.own["field_declination"] = field_declination();
  kit.own.insert(own_effect("attitude_bias", effects::AttitudeBias{}));
  return kit;
}

EffectKit attitude_independent_effects() {
  Port bias{"bias", "uT", {}, largest_field};
  Port axis_scale{"axis_scale", "1", {}, largest_scale};
  for (const char* axis : axes) {
    bias.components.push_back({.name = axis, .input = std::string("m").append(axis), .sign = -1.0});
    axis_scale.components.push_back(
        {.name = axis, .input = std::string("axis_scale_").append(axis)});
  }
  EffectKit kit;
  kit.ports = {
      bias, {"scale", "1", {Component{.name = "s", .input = "scale"}}, largest_scale}, axis_scale};
  add_switched(kit, bias);
  return kit;
}

}  // namespace sepcal::catalogue
