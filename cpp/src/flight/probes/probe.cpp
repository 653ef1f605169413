// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/probe.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sepcal {
std::string command_of(std::string_view app, std::string_view verb) {
  if (!app.starts_with(own_app)) return fmt::format("{} {}", app, verb);
  const std::string_view model = app.substr(own_app.size());
  return fmt::format("{} {}{}", own_app, verb, model.empty() ? " --model FILE.py:CLASS" : model);
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

}  // namespace sepcal
