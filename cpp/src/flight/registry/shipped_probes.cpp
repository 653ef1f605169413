// SPDX-License-Identifier: BSD-3-Clause
// The probes that ship, each a row. A new one registers here, and nowhere else.
#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flight/catalogue/effect_table.hpp"
#include "flight/export/exporter.hpp"
#include "flight/probes/shipped.hpp"

namespace sepcal {
namespace {

struct ShippedProbe {
  const probes::Shipped* probe;
  catalogue::EffectTable (*effects)();
  const exporting::Exporter& (*exporter)() = nullptr;  // of one that has a correction to export
};

using namespace catalogue;
using namespace exporting;
using namespace probes;

constexpr std::array probe_rows{
    ShippedProbe{&shipped_five_hole, five_hole_effects, five_hole_exporter},
    ShippedProbe{&shipped_vane_boom, vane_boom_effects},
    ShippedProbe{&shipped_pitot_static, pitot_static_effects, pitot_static_exporter},
    ShippedProbe{&shipped_magnetometer, magnetometer_effects, known_field_exporter},
    ShippedProbe{&shipped_attitude_independent, attitude_independent_effects,
                 field_strength_exporter},
};

}  // namespace

std::span<const Shipped* const> probes::shipped() {
  static const auto all = [] {
    std::array<const Shipped*, probe_rows.size()> each{};
    std::ranges::transform(probe_rows, each.begin(), &ShippedProbe::probe);
    return each;
  }();
  return all;
}

const std::map<std::string, EffectTable, std::less<>>& catalogue::effect_tables() {
  static const auto tables = [] {
    std::map<std::string, EffectTable, std::less<>> by_name;
    for (const ShippedProbe& each : probe_rows) {
      by_name.emplace(each.probe->name, each.effects());
    }
    return by_name;
  }();
  return tables;
}

std::vector<std::string_view> exporting::exported_probes() {
  std::vector<std::string_view> names;
  for (const ShippedProbe& each : probe_rows) {
    if (each.exporter != nullptr) names.push_back(each.probe->name);
  }
  return names;
}

const Exporter* exporting::find_exporter(std::string_view probe) {
  const auto named = [](const ShippedProbe& each) { return each.probe->name; };
  const auto* const found = std::ranges::find(probe_rows, probe, named);
  const bool exports = found != probe_rows.end() && found->exporter != nullptr;
  return exports ? &found->exporter() : nullptr;
}

}  // namespace sepcal
