// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/effect_makers.hpp"

namespace sepcal::catalogue {

EffectKit::Maker renamed(const std::string& means, const Port& port) {
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    return make_named(setting.name, parse_effect_name(means), port, model, setting, record);
  };
}

EffectKit::Maker in_time(Delay::Kind kind, double bound, const std::vector<std::string>& inputs) {
  return [=](const BlockModel& /*model*/, EffectSetting& setting, Record& /*record*/) {
    Effect effect{.name = setting.name};
    effect.delays.push_back({kind, Variable(setting.name + ".tau", "s", -bound, bound), inputs});
    return effect;
  };
}

}  // namespace sepcal::catalogue
