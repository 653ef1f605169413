// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/named_effects.hpp"

#include <algorithm>

#include "base/name_list.hpp"
#include "effects/named_driver.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace effects;  // this room's own

namespace {

/// Those of the kit; a port's with `driver`, as "[time]".
std::vector<std::string> known_names(const EffectKit& kit, const std::string& driver) {
  std::vector<std::string> names;
  for (const Port& port : kit.ports) names.push_back(port.name + driver);
  for (const auto& [name, maker] : kit.own) names.push_back(name);
  for (const auto& [name, resolve] : kit.aliases) names.push_back(name);
  return names;
}

std::string describe_unknown(const std::string& name, const EffectKit& kit) {
  const std::size_t bracket = std::min(name.find('['), name.size());
  constexpr std::size_t shortest = 3;  // in a shorter name a letter makes another
  const std::size_t slips = bracket < shortest ? 0 : std::max<std::size_t>(1, bracket / 4);
  const std::string similar =
      base::ask_for_similar(name, known_names(kit, name.substr(bracket)), slips);
  return "there is no effect '" + name + "'" +
         (similar.empty() ? "; known: " : similar + " Known: ") +
         base::list_names(known_names(kit, "[driver]"));
}

Effect make_effect(const EffectKit& kit, const BlockModel& model, EffectSetting& setting,
                   Record& record) {
  EffectName name = parse_effect_name(setting.name);
  const auto alias = kit.aliases.find(name.text);
  if (alias != kit.aliases.end()) name = parse_effect_name(alias->second(record));
  setting.name = name.text;
  const auto own = kit.own.find(name.text);
  if (own != kit.own.end()) return own->second(model, setting, record);
  const auto port = std::ranges::find(kit.ports, name.port, &Port::name);
  if (port != kit.ports.end() && name.shape == EffectName::Shape::none) {
    throw Error("effect '" + name.text + "' needs a driver: write " + name.text + "[time] or " +
                name.text + "[COLUMN]");
  }
  if (port == kit.ports.end()) {
    if (setting.known) {
      throw Error("effect '" + name.text +
                  "' is not in the catalogue; if it is one of your own, it can be used only where "
                  "it is defined: load the calibration there");
    }
    throw Error(describe_unknown(name.text, kit));
  }
  return make_named(name.text, name, *port, model, setting, record);
}

}  // namespace

Effect make_named(const std::string& owner, const EffectName& means, const Port& port,
                  const BlockModel& model, EffectSetting& setting, Record& record) {
  for (const std::string& channel : driver_channels(means)) {
    const auto& outputs = model.tables().outputs;
    if (std::ranges::find(outputs, channel, &Variable::name) == outputs.end()) continue;
    throw Error("effect " + means.text + ": '" + channel +
                "' is what is measured; a driver must be another channel, or it explains itself");
  }
  const DriverPointer driver = make_named_driver(means, port, setting, record);
  return make_driven(owner, port, driver, coefficient_unit(port.unit, means), model, record);
}

EffectKit plain_kit(const Tables& model) {
  EffectKit kit;
  for (const Variable& parameter : model.linear) {
    kit.ports.push_back(
        {parameter.name, parameter.unit, {{.name = "s", .linear = parameter.name}}});
  }
  for (const Variable& input : model.inputs) {
    kit.ports.push_back({.name = input.name,
                         .unit = input.unit,
                         .components = {{.name = "s", .input = input.name}},
                         .constant_is_own = false});
  }
  return kit;
}

std::vector<Effect> make_effects(const EffectKit& kit, const BlockModel& model,
                                 std::vector<EffectSetting>& settings, Record& record) {
  std::vector<Effect> effects;
  for (EffectSetting& setting : settings) {
    effects.push_back(make_effect(kit, model, setting, record));
    setting.known = true;
  }
  return effects;
}

}  // namespace sepcal
