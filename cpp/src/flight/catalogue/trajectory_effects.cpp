// SPDX-License-Identifier: BSD-3-Clause
// The effects along a trajectory: what the inertial unit, the air data and the attitude lack, and
// the wind. Of a flight path they act on what is integrated, of an aircraft on what is read.
#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "flight/catalogue/effect_makers.hpp"
#include "flight/catalogue/effect_table.hpp"

namespace sepcal::catalogue {
namespace {

constexpr double largest_acceleration = 3.0;  // [m/s^2] of an accelerometer's bias
constexpr double largest_rate = 0.2;          // [rad/s] of a gyro's
constexpr double largest_share = 0.5;         // of what is scaled
constexpr double strongest_wind = 60.0;       // [m/s] of a change
constexpr double farthest = 5.0;              // [m] of the vane
constexpr std::array<const char*, 3> body_axes{"x", "y", "z"};
const std::vector<std::string> force_inputs{"ax", "ay", "az"};
const std::vector<std::string> rate_inputs{"p", "q", "r"};

Port scales(const std::string& name, const std::vector<std::string>& inputs) {
  Port port{.name = name,
            .unit = "1",
            .components = {},
            .plausible = largest_share,
            .constant_is_own = false};
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    port.components.push_back({.name = body_axes[i], .input = inputs[i], .times = inputs[i]});
  }
  return port;
}

/// Every input of a triad reads a share of the others.
Port crosses(const std::string& name, const std::vector<std::string>& inputs) {
  Port port{.name = name, .unit = "1", .components = {}, .plausible = largest_share};
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    for (std::size_t k = 0; k < inputs.size(); ++k) {
      if (k == i) continue;
      port.components.push_back({.name = std::string(body_axes[i]) + body_axes[k],
                                 .input = inputs[i],
                                 .times = inputs[k]});
    }
  }
  return port;
}

Port g_sensitivity() {
  Port port{
      .name = "gyro_g_sensitivity", .unit = "rad s/m", .components = {}, .plausible = largest_rate};
  for (std::size_t i = 0; i < rate_inputs.size(); ++i) {
    for (std::size_t k = 0; k < force_inputs.size(); ++k) {
      port.components.push_back({.name = std::string(body_axes[i]) + body_axes[k],
                                 .input = rate_inputs[i],
                                 .times = force_inputs[k]});
    }
  }
  return port;
}

EffectRow constant_row(const Port& port, const std::string& equation, const std::string& sentence,
                       const std::vector<std::string>& channels = {}) {
  return {.entry = CataloguedEffect{port.name, equation, "none", port.unit},
          .sentence = sentence,
          .channels = channels,
          .maker = constant_on(port)};
}

EffectRow step_row(const std::string& name, const Port& port, const std::string& equation,
                   const std::string& sentence) {
  return {.entry = CataloguedEffect{name, equation, "time", port.unit},
          .sentence = sentence,
          .channels = {"time"},
          .maker = renamed(port.name + "[step(time)]", port)};
}

/// What is late against the inertial unit or the controls.
EffectRow late_row(const std::string& name, const std::string& input, const std::string& what) {
  const Port port{.name = name,
                  .unit = "s",
                  .components = {{.name = "tau", .input = input}},
                  .plausible = longest_offset};
  return constant_row(port, what + " late by tau", "the time of " + what + " is late", {"time"});
}

std::vector<EffectRow> late_readings() {
  return {late_row("airdata_late", "airdata_delay", "airspeed, alpha and beta"),
          late_row("alpha_late", "alpha_delay", "alpha"),
          late_row("attitude_late", "attitude_delay", "roll, pitch and yaw")};
}

/// What is read beside the inertial unit, in the models' linear parameters.
std::vector<PortRow> reading_rows() {
  const Port airspeed_scale{"airspeed_scale", "1", {{.name = "s", .linear = "lambda_v"}}};
  const Port airspeed_bias{"airspeed_bias", "m/s", {{.name = "s", .linear = "b_v"}}};
  const Port alpha_scale{"alpha_scale", "1", {{.name = "s", .linear = "lambda_alpha"}}};
  const Port alpha_bias{"alpha_bias", "rad", {{.name = "s", .linear = "b_alpha"}}};
  const Port beta_scale{"beta_scale", "1", {{.name = "s", .linear = "lambda_beta"}}};
  const Port beta_bias{"beta_bias", "rad", {{.name = "s", .linear = "b_beta"}}};
  const Port attitude_bias{
      "attitude_bias",
      "rad",
      {{.name = "roll", .linear = "b_phi"}, {.name = "pitch", .linear = "b_theta"}}};
  const auto row = [](const Port& port, const std::string& sentence, const std::string& equation) {
    return PortRow{.port = port, .sentence = sentence, .forms = {{any_driver, equation}}};
  };
  std::vector<PortRow> rows{
      row(airspeed_scale, "the airspeed's scale changes", "V as read = (1 + lambda + s x) V"),
      row(airspeed_bias, "the airspeed's bias changes", "V as read + s x"),
      row(alpha_scale, "the scale of alpha changes", "alpha as read = (1 + lambda + s x) alpha"),
      row(alpha_bias, "the bias of alpha changes", "alpha as read + s x"),
      row(beta_scale, "the scale of beta changes", "beta as read = (1 + lambda + s x) beta"),
      row(beta_bias, "the bias of beta changes", "beta as read + s x"),
      row(attitude_bias, "the bias of the attitude changes", "roll, pitch as read + s x")};
  return rows;
}

std::vector<Channel> channels() {
  return {{"temp", "temp_degc (of the inertial unit)"}, {"altitude", "altitude_m"}};
}

EffectTable path_effects() {
  const Port accel_bias{.name = "accel_bias",
                        .unit = "m/s^2",
                        .components = {{.name = "x", .input = "ax"},
                                       {.name = "y", .input = "ay"},
                                       {.name = "z", .input = "az"}},
                        .plausible = largest_acceleration};
  const Port gyro_bias{.name = "gyro_bias",
                       .unit = "rad/s",
                       .components = {{.name = "x", .input = "p"},
                                      {.name = "y", .input = "q"},
                                      {.name = "z", .input = "r"}},
                       .plausible = largest_rate};
  const Port accel_scale = scales("accel_scale", force_inputs);
  const Port gyro_scale = scales("gyro_scale", rate_inputs);
  const Port wind{.name = "wind",
                  .unit = "m/s",
                  .components = {{.name = "n", .input = "wind_change_n"},
                                 {.name = "e", .input = "wind_change_e"},
                                 {.name = "d", .input = "wind_change_d"}},
                  .plausible = strongest_wind,
                  .causes = time_and_place()};
  const Port vane{.name = "vane_position",
                  .unit = "m",
                  .components = {{.name = "x", .input = "vane_shift_x"},
                                 {.name = "y", .input = "vane_shift_y"},
                                 {.name = "z", .input = "vane_shift_z"}},
                  .plausible = farthest};
  EffectTable table;
  table.ports = reading_rows();
  table.ports.insert(table.ports.begin(),
                     {{.port = gyro_bias,
                       .sentence = "the gyros' bias changes",
                       .forms = {{any_driver, "(p, q, r) as read + s x"}},
                       .curves = {{"time", "spline({},5)"}, {"temp", "{}^2"}}},
                      {.port = accel_bias,
                       .sentence = "the accelerometers' bias changes",
                       .forms = {{any_driver, "(ax, ay, az) as read + s x"}},
                       .curves = {{"time", "spline({},5)"}, {"temp", "{}^2"}}},
                      {.port = gyro_scale,
                       .sentence = "the gyros' scale changes",
                       .forms = {{any_driver, "(1 + s x) (p, q, r)"}}},
                      {.port = accel_scale,
                       .sentence = "the accelerometers' scale changes",
                       .forms = {{any_driver, "(1 + s x) (ax, ay, az)"}}},
                      {.port = wind,
                       .sentence = "the wind changes",
                       .acts_on = ActsOn::world,
                       .forms = {{any_driver, "W + s x (n, e, d) about the air data"}},
                       .curves = {{"time", "spline({},5)"}}}});
  table.effects = {
      constant_row(accel_scale, "(1 + s) (ax, ay, az)", "the accelerometers' scale is off"),
      constant_row(gyro_scale, "(1 + s) (p, q, r)", "the gyros' scale is off"),
      constant_row(crosses("accel_misalignment", force_inputs), "ax + s ay + s az, and so on",
                   "the accelerometers are not square"),
      constant_row(crosses("gyro_misalignment", rate_inputs), "p + s q + s r, and so on",
                   "the gyros are not square"),
      constant_row(g_sensitivity(), "(p, q, r) + S (ax, ay, az)", "the gyros feel acceleration"),
      constant_row(vane, "the vane at its place + s", "the vane is not where it is said to be"),
      step_row("gyro_bias_step", gyro_bias, "(p, q, r) as read + s after t0",
               "the gyros' bias changes at one time"),
      step_row("accel_bias_step", accel_bias, "(ax, ay, az) as read + s after t0",
               "the accelerometers' bias changes at one time"),
      {.entry = CataloguedEffect{"imu_late", "the inertial unit late by tau", "none", "s"},
       .sentence = "the inertial unit's time is late",
       .channels = {"time"},
       .maker =
           in_time(Delay::Kind::inputs_late, longest_offset, {"ax", "ay", "az", "p", "q", "r"})}};
  std::ranges::copy(late_readings(), std::back_inserter(table.effects));
  table.effects.push_back(
      late_row("velocity_late", "velocity_delay", "the velocity over the ground"));
  table.channels = channels();
  return table;
}

EffectTable aircraft_effects() {
  const Port accel_bias{"accel_bias",
                        "m/s^2",
                        {{.name = "x", .linear = "b_ax"},
                         {.name = "y", .linear = "b_ay"},
                         {.name = "z", .linear = "b_az"}}};
  const Port gyro_bias{"gyro_bias",
                       "rad/s",
                       {{.name = "x", .linear = "b_p"},
                        {.name = "y", .linear = "b_q"},
                        {.name = "z", .linear = "b_r"}}};
  EffectTable table;
  table.ports = reading_rows();
  table.ports.insert(table.ports.begin(),
                     {{.port = gyro_bias,
                       .sentence = "the gyros' bias changes",
                       .forms = {{any_driver, "(p, q, r) as read + s x"}}},
                      {.port = accel_bias,
                       .sentence = "the accelerometers' bias changes",
                       .forms = {{any_driver, "(ax, ay, az) as read + s x"}}}});
  table.effects = {
      {.entry = CataloguedEffect{"controls_late", "the controls late by tau", "none", "s"},
       .sentence = "the controls' time is late",
       .channels = {"time"},
       .maker = [](const BlockModel& model, EffectSetting& setting, Record& record) {
         std::vector<std::string> controls;
         for (const Variable& input : model.tables().inputs) {
           for (const char* control : {"elevator", "aileron", "rudder", "throttle"}) {
             if (input.name == control) controls.push_back(input.name);
           }
         }
         return in_time(Delay::Kind::inputs_late, longest_offset, controls)(model, setting, record);
       }}};
  std::ranges::copy(late_readings(), std::back_inserter(table.effects));
  table.channels = channels();
  return table;
}

}  // namespace

const std::map<std::string, EffectTable, std::less<>>& trajectory_tables() {
  static const std::map<std::string, EffectTable, std::less<>> tables{
      {"path", path_effects()}, {"aircraft", aircraft_effects()}};
  return tables;
}

const EffectTable& trajectory_table(std::string_view model) {
  return trajectory_tables().find(model)->second;
}

}  // namespace sepcal::catalogue
