// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/plausible_scales.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string>
#include <vector>

#include "base/sentences.hpp"
#include "sepcal/detail/models/scale.hpp"

namespace sepcal::probes {

void judge_scales(Fit& fit, std::span<const Scale> scales) {
  constexpr double gross = 0.2;
  constexpr double least = least_scale * (1.0 + 1e-9);  // a bound of 0.05 - 1 is rounded
  std::vector<std::string> lost;
  std::vector<std::string> far;
  for (const Scale& scale : scales) {
    const Parameter& parameter = fit[scale.parameter];
    if (parameter.fixed) continue;
    const double error = parameter.value - scale.nominal;
    if (1.0 + error <= least) {
      lost.push_back(parameter.name);
    } else if (std::abs(error) > gross) {
      far.push_back(fmt::format("{} {:.3g}", parameter.name, parameter.value));
    }
  }
  const auto say = [&](const std::string& sentence) {
    fit.message = base::join_sentences({fit.message, sentence});
  };
  if (!lost.empty()) {
    for (const std::string& name : lost) {
      fit.identifiability.unobservable.push_back({{name}, name, infinity});
    }
    if (fit.status == FitStatus::converged) fit.status = FitStatus::not_identifiable;
    say(
        fmt::format("{} came out at {:g} of what a sensor has, or below: readings that run against "
                    "the model, or too little of a turn; look for a sign, a unit or an axis",
                    fmt::join(lost, ", "), least_scale));
  }
  if (!far.empty()) {
    say(fmt::format(
        "{} looks like a wrong unit or sign in a header (a scale is seldom more than {:g} "
        "off), or another minimum",
        fmt::join(far, ", "), gross));
  }
}

}  // namespace sepcal::probes
