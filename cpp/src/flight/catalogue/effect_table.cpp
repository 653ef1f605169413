// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/effect_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "flight/probes/shipped.hpp"
#include "sepcal/error.hpp"

namespace sepcal::catalogue {

const PortRow* EffectTable::find_port(const std::string& name) const {
  const auto row =
      std::ranges::find(ports, name, [](const PortRow& each) { return each.port.name; });
  return row == ports.end() ? nullptr : &*row;
}

const EffectRow* EffectTable::find_effect(const std::string& name) const {
  const auto row = std::ranges::find(effects, name, &EffectRow::name);
  return row == effects.end() ? nullptr : &*row;
}

const std::map<std::string, EffectTable, std::less<>>& effect_tables() {
  static const std::map<std::string, EffectTable, std::less<>> tables = [] {
    std::map<std::string, EffectTable, std::less<>> by_name;
    for (const probes::Shipped* probe : probes::shipped()) {
      by_name.emplace(probe->name, probe->effects());
    }
    return by_name;
  }();
  return tables;
}

const EffectTable& effect_table(std::string_view probe) {
  const auto found = effect_tables().find(probe);
  if (found == effect_tables().end()) throw Error(fmt::format("there is no model '{}'", probe));
  return found->second;
}

}  // namespace sepcal::catalogue
