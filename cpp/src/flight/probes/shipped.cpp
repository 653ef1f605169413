// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/shipped.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ranges>

#include "sepcal/error.hpp"

namespace sepcal {
namespace probes {

namespace {

const std::vector<double>& numbers(const Settings& settings, const std::string& name,
                                   std::size_t length) {
  const auto at = settings.find(name);
  if (at == settings.end() || at->second.size() != length) {
    throw Error(fmt::format("option '{}' needs {} number{}", name, length, length == 1 ? "" : "s"));
  }
  return at->second;
}

}  // namespace

double one_number(const Settings& settings, const std::string& name) {
  return numbers(settings, name, 1).front();
}

std::array<double, 3> three_numbers(const Settings& settings, const std::string& name) {
  const std::vector<double>& values = numbers(settings, name, 3);
  return {values[0], values[1], values[2]};
}

}  // namespace probes

std::vector<ShippedName> shipped_probes() {
  std::vector<ShippedName> names;
  for (const probes::Shipped* each : probes::shipped()) {
    names.push_back({std::string(each->name), std::string(each->words)});
  }
  return names;
}

std::unique_ptr<const Probe> make_probe(std::string_view name, const probes::Settings& settings) {
  const auto all = probes::shipped();
  const auto one = std::ranges::find(all, name, &probes::Shipped::name);
  if (one != all.end()) return (*one)->make(settings);
  throw Error(fmt::format(
      "there is no model '{}'; known: {}", name,
      fmt::join(all | std::views::transform([](const auto* each) { return each->name; }), ", ")));
}

}  // namespace sepcal
