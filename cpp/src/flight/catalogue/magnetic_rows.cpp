// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/magnetic_rows.hpp"

#include "flight/catalogue/effect_makers.hpp"

namespace sepcal::catalogue {

PortRow bias_row(const Port& bias, std::vector<Form> forms) {
  forms.insert(forms.begin(), {any_driver, "m + s x (x, y, z)"});
  return {.port = bias,
          .sentence = "the field at the sensor changes",
          .forms = std::move(forms),
          .curves = {{"time", "spline({},6)"},
                     {"temp", "{}^2"},
                     {"throttle", "{}^n"},
                     {"current", "delay({})"}}};
}

PortRow scale_row(const Port& scale, const std::string& equation) {
  return {
      .port = scale, .sentence = "the sensor's scale changes", .forms = {{any_driver, equation}}};
}

PortRow axis_scale_row(const Port& axis_scale, const std::string& equation) {
  return {.port = axis_scale,
          .sentence = "the scales of the sensor's axes change",
          .forms = {{any_driver, equation}}};
}

EffectRow bias_step_row(const Port& bias) {
  return {.entry = CataloguedEffect{"bias_step", "m + s from t0 on (x, y, z), t0 by a scan", "time",
                                    "uT"},
          .sentence = "something was switched on that bends the field",
          .channels = {"time"},
          .maker = renamed("bias[step(time)]", bias)};
}

EffectRow warm_up_row(const Port& bias) {
  return {
      .entry = CataloguedEffect{"warm_up", "m + s exp(-(t - t_first) / tau) (x, y, z), tau fitted",
                                "time", "uT"},
      .sentence = "the sensor's bias settles after it is switched on",
      .channels = {"time"},
      .maker = renamed("bias[decay(time)]", bias)};
}

std::vector<AliasRow> magnetic_aliases() {
  return {{"bias_drift", "bias[time]", "time", "uT per s"}};
}

std::vector<Channel> magnetic_channels() {
  return {{"current", "current_a"},
          {"throttle", "throttle"},
          {"voltage", "voltage_v"},
          {"temp", "temp_degc"}};
}

ErrorBound field_bound(std::vector<std::string> outputs) {
  return {.name = "field", .unit = "uT", .size = 0.3, .outputs = std::move(outputs)};
}

}  // namespace sepcal::catalogue
