// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/probe.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Settings = std::map<std::string, std::vector<double>>;

/// A setting of `length` numbers. Throws Error where it is missing or of another length.
template <std::size_t length>
std::array<double, length> setting(const Settings& settings, const std::string& name) {
  const auto at = settings.find(name);
  if (at == settings.end() || at->second.size() != length) {
    throw Error(fmt::format("option '{}' needs {} number{}", name, length, length == 1 ? "" : "s"));
  }
  std::array<double, length> values{};
  std::ranges::copy(at->second, values.begin());
  return values;
}

}  // namespace

std::string command_of(std::string_view app, std::string_view verb) {
  return fmt::format("{} {}{}", app, verb, app == own_app ? " --model FILE.py:CLASS" : "");
}

bool is_initial_state(const Probe& probe, std::string_view parameter) {
  return std::ranges::any_of(probe.initial_states(), [&](const std::string& state) {
    const std::string_view rest = parameter.substr(std::min(state.size(), parameter.size()));
    return parameter.starts_with(state) && (rest.empty() || rest.front() == '[');
  });
}

std::vector<Variable> lasting_parameters(const Probe& probe) {
  std::vector<Variable> lasting = probe.model().tables().parameters();
  std::erase_if(lasting, [&](const Variable& each) { return is_initial_state(probe, each.name); });
  return lasting;
}

std::vector<DerivedQuantity> Probe::derive(const Fit& /*fit*/) const { return {}; }

void Probe::judge(Fit& /*fit*/) const {}

std::unique_ptr<const Probe> make_probe(std::string_view name, const Settings& settings) {
  if (name == "five-hole") {
    return five_hole_probe(setting<1>(settings, "k_alpha")[0], setting<1>(settings, "k_beta")[0],
                           setting<3>(settings, "lever_arm"));
  }
  if (name == "pitot-static") return pitot_static_probe();
  if (name == "magnetometer") {
    std::optional<std::array<double, 3>> field;
    if (settings.contains("field")) field = setting<3>(settings, "field");
    if (!settings.contains("mounting")) return magnetometer_probe(field);
    if (settings.at("mounting").empty()) return magnetometer_probe(field, std::nullopt);
    return magnetometer_probe(field, setting<3>(settings, "mounting"));
  }
  if (name == "magnetometer-norm") {
    const double strength = setting<1>(settings, "field_strength")[0];
    return attitude_independent_probe(strength, setting<1>(settings, "field_noise")[0]);
  }
  throw Error(
      fmt::format("there is no model '{}'; known: five-hole, pitot-static, magnetometer, "
                  "magnetometer-norm",
                  name));
}

}  // namespace sepcal
