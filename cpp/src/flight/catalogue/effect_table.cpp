// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/effect_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sepcal/error.hpp"
#include "sepcal/flight/probe.hpp"

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

const EffectTable& effect_table(std::string_view probe) {
  const auto found = effect_tables().find(probe);
  if (found == effect_tables().end()) throw Error(fmt::format("there is no model '{}'", probe));
  return found->second;
}

}  // namespace sepcal::catalogue

namespace sepcal {

const catalogue::EffectTable& Probe::effects() const { return catalogue::effect_table(name()); }

}  // namespace sepcal
