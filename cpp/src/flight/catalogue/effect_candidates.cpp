// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/effect_candidates.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sepcal/effect_name.hpp"

namespace sepcal::catalogue {

/// Channels under their own header; what is measured can't drive an effect.
std::vector<std::string> list_drivers(const EffectTable& table, const Record& record,
                                      const Flight& flight) {
  std::vector<std::string> drivers{"time"};
  drivers.insert(drivers.end(), table.state_drivers.begin(), table.state_drivers.end());
  std::erase_if(drivers, [&](const std::string& state) { return !record.has(state); });
  for (const std::string& name : record.names()) {
    if (flight.find(name) == nullptr || !can_name(name)) continue;
    if (std::ranges::find(drivers, name) != drivers.end()) continue;
    if (std::ranges::find(table.measured, name) == table.measured.end()) drivers.push_back(name);
  }
  return drivers;
}

std::string describe_driver(const EffectName& name) {
  switch (name.shape) {
    case EffectName::Shape::spline:
      return fmt::format("smoothly with {}", name.base);
    case EffectName::Shape::levels:
      return fmt::format("in steps of {}", name.base);
    case EffectName::Shape::power:
      return name.number > 1 ? fmt::format("with {}^{}", name.base, name.number)
                             : fmt::format("with {}", name.base);
    case EffectName::Shape::product:
      return fmt::format("with {}", name.base);
    case EffectName::Shape::exponent:
      return fmt::format("with a power of {}", name.base);
    case EffectName::Shape::step:
      return "at one time";
    case EffectName::Shape::ramp:
      return "steadily from some time on";
    case EffectName::Shape::decay:
      return "and settles";
    default:
      return fmt::format("with {}, delayed", name.base);
  }
}

namespace {

std::string describe_one(const EffectTable& table, const std::string& name) {
  if (const EffectRow* own = table.find_effect(name)) return own->sentence;
  const EffectName parsed = parse_effect_name(name);
  const PortRow* row = table.find_port(parsed.port);
  if (row == nullptr || parsed.shape == EffectName::Shape::none) return "your own effect " + name;
  if (parsed.base == "maneuver") return row->by_maneuver;
  return row->sentence + " " + describe_driver(parsed);
}

}  // namespace

std::vector<std::string> list_candidates(const EffectTable& table, const EffectKit& kit,
                                         const Record& record, const Flight& flight) {
  std::vector<std::string> names;
  for (const auto& [name, maker] : kit.own) names.push_back(name);
  const std::vector<std::string> drivers = list_drivers(table, record, flight);
  for (const PortRow& row : table.ports) {
    for (const std::string& driver : drivers) {
      names.push_back(fmt::format("{}[{}]", row.port.name, driver));
      for (const Curve& curve : row.curves) {
        if (!driver.starts_with(curve.channel)) continue;
        names.push_back(
            fmt::format("{}[{}]", row.port.name, fmt::format(fmt::runtime(curve.driver), driver)));
      }
    }
  }
  if (flight.maneuvers().empty()) return names;
  for (const PortRow& row : table.ports) {
    if (!row.by_maneuver.empty()) names.push_back(row.port.name + "[maneuver]");
  }
  return names;
}

std::vector<std::string> list_missing_channels(const EffectTable& table, const Flight& flight) {
  std::vector<std::string> missing;
  for (const Channel& channel : table.channels) {
    const bool logged = std::ranges::any_of(flight.columns(), [&](const Flight::Column& column) {
      return column.header.starts_with(channel.beginning);
    });
    if (!logged) missing.push_back(channel.name);
  }
  return missing;
}

std::string describe_effect(const EffectTable& table, const std::string& name) {
  std::string sentence;
  for (const std::string& part : split_effects(name)) {
    if (!sentence.empty()) sentence += ", and ";
    sentence += describe_one(table, part);
  }
  return sentence;
}

}  // namespace sepcal::catalogue
