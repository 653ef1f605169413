// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/prior_checks.hpp"

#include <cmath>
#include <utility>

#include "base/short_number.hpp"

namespace sepcal::estimation {
namespace {

/// Nothing where they agree.
std::string judge(const Parameter& parameter, const Normal& prior) {
  constexpr double far = 4.0;         // standard deviations of the difference
  constexpr double less_sure = 1.05;  // rounding and the noise model's own error aside
  const double error = std::isfinite(parameter.standard_error) ? parameter.standard_error : 0.0;
  const double sd = prior.standard_deviation;
  const std::string text = base::short_number(prior.mean) + " +- " + base::short_number(sd);
  if (std::abs(parameter.value - prior.mean) > far * std::hypot(sd, error)) {
    return "'" + parameter.name + "' came out as " + base::short_number(parameter.value) +
           ", far from its prior, " + text;
  }
  if (error > less_sure * sd) {
    return "'" + parameter.name + "' is less sure than its prior, " + text +
           ": its residuals are coloured, and the measurements weigh more than they know; give the "
           "outputs' noise (about " +
           base::short_number(error / parameter.standard_error_white) + " times as large as found)";
  }
  return "";
}

}  // namespace

std::vector<std::string> judge_priors(const std::vector<Parameter>& parameters,
                                      const FitOptions& options) {
  std::vector<std::string> sentences;
  for (const Parameter& parameter : parameters) {
    const auto prior = options.prior.find(parameter.name);
    if (prior == options.prior.end()) continue;
    std::string sentence = judge(parameter, prior->second);
    if (!sentence.empty()) sentences.push_back(std::move(sentence));
  }
  return sentences;
}

}  // namespace sepcal::estimation
