// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/default_bounds.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sepcal/detail/models/scale.hpp"

namespace sepcal::verbs {

Bounds find_bounds_beyond(const Fit& fit, const Bounds& given) {
  constexpr double widths = 2.0;
  Bounds beyond;
  for (const Parameter& parameter : fit.parameters) {
    const double width = parameter.upper - parameter.lower;
    if (!parameter.at_bound || !std::isfinite(width) || given.contains(parameter.name)) continue;
    Interval tried{parameter.lower, parameter.upper};
    if (parameter.value - parameter.lower < parameter.upper - parameter.value) {
      tried.lower -= widths * width;
      if (parameter.name.starts_with("lambda_")) {
        tried.lower = std::max(tried.lower, least_scale - 1.0);
      }
    } else {
      tried.upper += widths * width;
    }
    if (tried.upper - tried.lower > width) beyond.emplace(parameter.name, tried);
  }
  return beyond;
}

bool is_regular_beyond(const Bounds& tried, const Fit& at_bounds, const Fit& beyond) {
  constexpr double clearly = 2.0;  // standard errors
  const bool refuted = std::ranges::all_of(tried, [&](const auto& bound) {
    const Parameter& parameter = beyond[bound.first];
    return std::abs(parameter.value - at_bounds[bound.first].value) >
           clearly * parameter.standard_error;
  });
  return refuted && beyond.status == FitStatus::converged && beyond.cost < at_bounds.cost &&
         std::ranges::none_of(beyond.parameters, &Parameter::at_bound);
}

bool has_plausible_scales(const Fit& fit) {
  constexpr double gross = 0.25;
  double sum = 0.0;
  int count = 0;
  for (const Parameter& parameter : fit.parameters) {
    if (!parameter.name.starts_with("lambda_")) continue;
    sum += parameter.value;
    ++count;
  }
  return std::abs(sum) <= gross * count;
}

std::string describe_beyond(const Bounds& tried, const Fit& at_bounds, const Fit& beyond,
                            bool adopted) {
  std::vector<std::string> ends;
  std::vector<std::string> values;
  std::vector<std::string> options;
  for (const auto& [name, interval] : tried) {
    ends.push_back(
        fmt::format("{} ended at its default bound of {:.4g}", name, at_bounds[name].value));
    values.push_back(fmt::format("{:.4g}", beyond[name].value));
    options.push_back(
        fmt::format("--bounds {}={:.4g},{:.4g}", name, interval.lower, interval.upper));
  }
  if (adopted) {
    return fmt::format("{}, which was widened, and the fit is regular beyond it: the same as {}",
                       fmt::join(ends, ", "), fmt::join(options, " "));
  }
  return fmt::format("{}, beyond which the fit is regular at {}: give {}", fmt::join(ends, ", "),
                     fmt::join(values, ", "), fmt::join(options, " "));
}

}  // namespace sepcal::verbs
