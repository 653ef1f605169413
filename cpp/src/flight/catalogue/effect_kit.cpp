// SPDX-License-Identifier: BSD-3-Clause
// The tables of effects as kits, from which effects are made by name.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "flight/catalogue/effect_channels.hpp"
#include "flight/catalogue/effect_table.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace catalogue;  // this room's own

namespace {

/// The row's maker, once the record has what the effect reads.
EffectKit::Maker checked_maker(const EffectRow& row) {
  return [&row](const BlockModel& model, EffectSetting& setting, Record& record) {
    std::vector<std::string> missing;
    for (const std::string& channel : row.channels) {
      if (!is_logged(record, channel)) missing.push_back(channel);
    }
    if (missing.empty()) {
      Effect effect = row.maker(model, setting, record);
      for (const auto& [component, range] : row.plausible) {
        effect.plausible[effect.name + "." + component] = range;
      }
      return effect;
    }
    throw Error(fmt::format("effect {} needs {}, which the flight doesn't log", row.name(),
                            fmt::join(missing, ", ")));
  };
}

/// What the alias stands for; of `port[altitude_*]` with the one column that is there.
std::string resolve(const AliasRow& alias, const Record& record) {
  constexpr std::string_view any = "_*]";
  if (!alias.means.ends_with(any)) return alias.means;
  const std::size_t bracket = alias.means.find('[');
  const std::string port = alias.means.substr(0, bracket);
  const std::string prefix =
      alias.means.substr(bracket + 1, alias.means.size() - any.size() - bracket - 1);
  std::vector<std::string> fitting;
  for (const std::string& name : record.names()) {
    if (name.starts_with(prefix)) fitting.push_back(name);
  }
  if (fitting.size() == 1) return fmt::format("{}[{}]", port, fitting.front());
  throw Error(fitting.empty()
                  ? fmt::format("effect {} needs a column {}*, which the flight doesn't log; under "
                                "another name it drives {}[COLUMN]",
                                alias.name, prefix, port)
                  : fmt::format("effect {} could be driven by {}; write {}[COLUMN]", alias.name,
                                fmt::join(fitting, ", "), port));
}

}  // namespace

EffectKit catalogue::kit_of(const EffectTable& table) {
  EffectKit kit;
  for (const PortRow& row : table.ports) kit.ports.push_back(row.port);
  for (const EffectRow& row : table.effects) kit.own[row.name()] = checked_maker(row);
  for (const AliasRow& row : table.aliases) {
    kit.aliases[row.name] = [&row](const Record& record) { return resolve(row, record); };
  }
  kit.attitude_errors = table.attitude_errors;
  kit.error_budget = table.error_budget;
  kit.disturbed = table.disturbed;
  return kit;
}

EffectKit effect_kit(const Probe& probe, const OwnEffects& own) {
  EffectKit kit = kit_of(probe.effects());
  for (const auto& [name, maker] : own) kit.own[name] = maker;
  return kit;
}

EffectKit effect_kit(std::string_view probe) { return kit_of(effect_table(probe)); }

}  // namespace sepcal
