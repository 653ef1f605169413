// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/effect_makers.hpp"

#include "sepcal/error.hpp"

namespace sepcal::catalogue {

EffectKit::Maker renamed(const std::string& means, const Port& port) {
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    return make_named(setting.name, parse_effect_name(means), port, model, setting, record);
  };
}

EffectKit::Maker constant_on(const Port& port) {
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    return make_driven(setting.name, port, constant_driver(), port.unit, model, record);
  };
}

EffectKit::Maker lacking_constant_on(const Port& port) {
  return
      [maker = constant_on(port)](const BlockModel& model, EffectSetting& setting, Record& record) {
        Effect effect = maker(model, setting, record);
        effect.driver = nullptr;
        return effect;
      };
}

EffectKit::Maker in_time(Delay::Kind kind, double bound, const std::vector<std::string>& inputs) {
  return [=](const BlockModel& /*model*/, EffectSetting& setting, Record& /*record*/) {
    Effect effect{.name = setting.name};
    effect.delays.push_back({kind, Variable(setting.name + ".tau", "s", -bound, bound), inputs});
    return effect;
  };
}

EffectKit::Maker drifting_clock(Delay::Kind kind, double bound,
                                const std::vector<std::string>& inputs) {
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    if (!setting.span) {
      const auto time = record.column("time");
      const auto& segments = record.segments();
      setting.span = {time[segments.front().first], time[segments.back().last - 1]};
    }
    if (!(setting.span->first < setting.span->second)) {
      throw Error("effect " + setting.name + " needs more than one time");
    }
    Effect effect = in_time(kind, bound, inputs)(model, setting, record);
    effect.delays.front().grows = setting.span;
    return effect;
  };
}

EffectKit::Maker attitude_error(const std::string& input) {
  return [=](const BlockModel& model, EffectSetting& /*setting*/, Record& record) {
    const Port port{.name = input, .unit = "rad", .components = {{.name = "s", .input = input}}};
    return make_driven(input + " error", port, constant_driver(), port.unit, model, record);
  };
}

std::vector<std::string> time_and_place() {
  return {"time", "maneuver", "alt", "height", "lat", "lon", "north", "east", "distance"};
}

ErrorBound tilt_bound() {
  return {.name = "tilt", .unit = "rad", .size = 0.005, .corrections = {0, 1}};
}

ErrorBound heading_bound() {
  return {.name = "heading", .unit = "rad", .size = 0.0175, .corrections = {2}};
}

}  // namespace sepcal::catalogue
