// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/knowledge.hpp"

#include <cmath>

#include "base/short_number.hpp"

namespace sepcal::estimation {
namespace {

std::string judge(const Parameter& parameter, const Normal& known) {
  constexpr double far = 4.0;         // standard deviations of the difference
  constexpr double less_sure = 1.05;  // rounding and the noise model's own error aside
  const double error = std::isfinite(parameter.standard_error) ? parameter.standard_error : 0.0;
  const double sd = known.standard_deviation;
  const std::string prior = base::short_number(known.mean) + " +- " + base::short_number(sd);
  if (std::abs(parameter.value - known.mean) > far * std::hypot(sd, error)) {
    return "'" + parameter.name + "' came out as " + base::short_number(parameter.value) +
           ", far from what is known of it, " + prior + "; ";
  }
  if (error > less_sure * sd) {
    return "'" + parameter.name + "' is less sure than it was known, " + prior +
           ": its residuals are coloured, and the measurements weigh more than they know; give the "
           "outputs' noise (about " +
           base::short_number(error / parameter.standard_error_white) +
           " times as large as found); ";
  }
  return "";
}

}  // namespace

std::string judge_knowledge(const std::vector<Parameter>& parameters, const FitOptions& options) {
  std::string text;
  for (const Parameter& parameter : parameters) {
    const auto known = options.knowledge.find(parameter.name);
    if (known != options.knowledge.end()) text += judge(parameter, known->second);
  }
  return text;
}

}  // namespace sepcal::estimation
