// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/held_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ranges>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal::verbs {
namespace {

void check_freed(const std::vector<Variable>& parameters, const CalibrationOptions& options) {
  for (const std::string& name : options.free) {
    if (std::ranges::find(parameters, name, &Variable::name) == parameters.end()) {
      throw OptionError(
          {Option{"free"},
           fmt::format(" {}: there is no such parameter; the model has: {}", name,
                       fmt::join(parameters | std::views::transform(&Variable::name), ", "))});
    }
    if (options.fit.fix.contains(name)) {
      throw OptionError({Option{"free"}, " " + name + " and ", Option{"fix"},
                         " " + name + " contradict each other; keep one"});
    }
  }
}

}  // namespace

CalibrationOptions hold(const Probe& probe, CalibrationOptions options) {
  return hold(probe.held(), probe.model().tables(), std::move(options));
}

CalibrationOptions hold(const std::map<std::string, double>& held, const Tables& tables,
                        CalibrationOptions options) {
  const std::vector<Variable> parameters = tables.parameters();
  check_freed(parameters, options);
  for (const auto& [name, value] : held) {
    if (std::ranges::find(parameters, name, &Variable::name) == parameters.end()) continue;
    if (std::ranges::find(options.free, name) != options.free.end()) continue;
    if (options.fit.bounds.contains(name) && !options.fit.fix.contains(name)) {
      throw OptionError({Option{"bounds"},
                         fmt::format(" {}: it is held at {} unless ", name, value), Option{"free"},
                         " " + name + " frees it; add that"});
    }
    options.fit.fix.emplace(name, value);
  }
  return options;
}

}  // namespace sepcal::verbs
