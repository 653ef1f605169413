// SPDX-License-Identifier: BSD-3-Clause
// The tables of effects as people read them: every port's forms, then the effects with a physics of
// their own, then the aliases.
#include "sepcal/detail/flight/effect_catalogue.hpp"

#include <map>
#include <vector>

#include "effects/named_driver.hpp"
#include "flight/catalogue/effect_table.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal {

using namespace catalogue;  // this room's own

namespace {

std::vector<CataloguedEffect> list_effects(const EffectTable& table) {
  std::vector<CataloguedEffect> list;
  for (const PortRow& row : table.ports) {
    for (const Form& form : row.forms) {
      const std::string name = row.port.name + "[" + form.driver + "]";
      list.push_back({name, form.equation, form.drivers,
                      form.driver == any_driver
                          ? row.port.unit + " per x"
                          : effects::coefficient_unit(row.port.unit, parse_effect_name(name))});
    }
  }
  for (const EffectRow& row : table.effects) list.push_back(row.entry);
  for (const AliasRow& row : table.aliases) {
    list.push_back({row.name, "alias of " + row.means, row.drivers, row.unit});
  }
  return list;
}

}  // namespace

std::vector<CataloguedEffect> effect_catalogue(const Probe& probe) {
  return list_effects(probe.effects());
}

std::span<const CataloguedEffect> effect_catalogue(std::string_view model) {
  static const auto catalogues = [] {
    std::map<std::string, std::vector<CataloguedEffect>, std::less<>> by_model;
    for (const auto* tables : {&effect_tables(), &trajectory_tables()}) {
      for (const auto& [name, table] : *tables) by_model[name] = list_effects(table);
    }
    return by_model;
  }();
  const auto found = catalogues.find(model);
  if (found == catalogues.end()) return {};
  return found->second;
}

}  // namespace sepcal
