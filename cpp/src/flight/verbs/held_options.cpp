// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/held_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ranges>

#include "flight/files/option_spelling.hpp"
#include "sepcal/error.hpp"

namespace sepcal::verbs {
namespace {

void check_freed(const Probe& probe, const CalibrationOptions& options) {
  const std::vector<Variable> parameters = probe.model().tables().parameters();
  for (const std::string& name : options.free) {
    if (std::ranges::find(parameters, name, &Variable::name) == parameters.end()) {
      throw Error(fmt::format(
          "{} {}: there is no such parameter; the model has: {}", files::spell_option("free"), name,
          fmt::join(parameters | std::views::transform(&Variable::name), ", ")));
    }
    if (options.fit.fixed.contains(name)) {
      throw Error(fmt::format("{1} {0} and {2} {0} contradict each other; keep one", name,
                              files::spell_option("free"), files::spell_option("fix")));
    }
  }
}

}  // namespace

CalibrationOptions hold(const Probe& probe, CalibrationOptions options) {
  check_freed(probe, options);
  for (const auto& [name, value] : probe.held()) {
    if (std::ranges::find(options.free, name) != options.free.end()) continue;
    if (options.fit.bounds.contains(name) && !options.fit.fixed.contains(name)) {
      throw Error(fmt::format("{2} {0}: it is held at {1} unless {3} {0} frees it; add that", name,
                              value, files::spell_option("bounds"), files::spell_option("free")));
    }
    options.fit.fixed.emplace(name, value);
  }
  return options;
}

}  // namespace sepcal::verbs
