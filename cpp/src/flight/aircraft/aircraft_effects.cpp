// SPDX-License-Identifier: BSD-3-Clause
#include "flight/aircraft/aircraft_effects.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "flight/aircraft/trajectory_effects.hpp"
#include "flight/catalogue/effect_candidates.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"

namespace sepcal::aircraft_log {
namespace {

/// What a coefficient is of, in the order of coefficient_names.
constexpr std::array<std::string_view, 6> meanings{"the force forward",   "the force to the right",
                                                   "the force down",      "the rolling moment",
                                                   "the pitching moment", "the yawing moment"};

const std::vector<std::string> of_symmetric_flow{
    "alpha",      "q_hat",          "elevator", "alpha^2",  "alpha^3",        "alpha*q_hat",
    "elevator^2", "alpha*elevator", "beta^2",   "throttle", "spline(alpha,5)"};
const std::vector<std::string> of_sideslip{
    "beta",          "p_hat",          "r_hat",    "aileron",       "rudder",
    "alpha*beta",    "beta*abs(beta)", "beta^3",   "alpha*p_hat",   "alpha*r_hat",
    "alpha*aileron", "alpha*rudder",   "throttle", "spline(beta,5)"};

std::string coefficients_in(const std::vector<AeroEquation>& equations) {
  std::vector<std::string> names;
  for (const AeroEquation& equation : equations) names.push_back(equation.coefficient);
  return fmt::format("{}", fmt::join(names, ", "));
}

[[noreturn]] void refuse_effect(const std::string& effect, std::size_t open, AircraftModel model,
                                const std::vector<AeroEquation>& equations) {
  const std::string coefficient = effect.substr(0, open);
  const bool is_coefficient =
      std::ranges::find(coefficient_names, coefficient) != coefficient_names.end();
  if (open != std::string::npos && is_coefficient) {
    throw Error(fmt::format("effect {}: the model '{}' has no {} here; it has {}", effect,
                            to_string(model), coefficient, coefficients_in(equations)));
  }
  throw Error(
      fmt::format("effect {}: write it as COEFFICIENT[REGRESSOR], as {}[alpha^2]; the "
                  "coefficients here are: {}",
                  effect, equations.front().coefficient, coefficients_in(equations)));
}

}  // namespace

bool is_spline(const std::string& effect) {
  const std::size_t open = effect.find("[spline(");
  return open != std::string::npos &&
         std::ranges::find(coefficient_names, effect.substr(0, open)) != coefficient_names.end();
}

std::size_t find_equation(const std::string& effect, const std::vector<AeroEquation>& equations,
                          AircraftModel model) {
  const std::size_t open = effect.find('[');
  const auto equation =
      std::ranges::find(equations, effect.substr(0, open), &AeroEquation::coefficient);
  if (open == std::string::npos || !effect.ends_with(']') || equation == equations.end()) {
    refuse_effect(effect, open, model, equations);
  }
  return static_cast<std::size_t>(equation - equations.begin());
}

std::vector<AeroEquation> with_regressors(std::vector<AeroEquation> equations,
                                          const AircraftOptions& options) {
  for (const EffectSetting& effect : options.calibration.effects) {
    const std::string& name = effect.name;
    if (acts_along(options.model, name) && !is_spline(name)) continue;
    const std::size_t equation = find_equation(name, equations, options.model);
    if (is_spline(name)) continue;
    const std::size_t open = name.find('[');
    equations[equation].regressors.push_back(name.substr(open + 1, name.size() - open - 2));
  }
  check_equations(equations);
  return equations;
}

std::vector<EffectSetting> splines_of(const std::vector<EffectSetting>& effects) {
  std::vector<EffectSetting> splines;
  for (const EffectSetting& effect : effects) {
    if (is_spline(effect.name)) splines.push_back(effect);
  }
  return splines;
}

void refuse_splines(const AircraftOptions& options, const std::string& why) {
  for (const EffectSetting& spline : splines_of(options.calibration.effects)) {
    throw Error(fmt::format(
        "effect {}: {}; add powers of it instead, or fit the coefficient with --model aero",
        spline.name, why));
  }
}

std::vector<EffectSetting> with_knots(std::vector<EffectSetting> effects,
                                      const std::vector<EffectSetting>& splines) {
  auto next = splines.begin();
  for (EffectSetting& effect : effects) {
    if (is_spline(effect.name)) effect = *next++;
  }
  return effects;
}

EffectKit coefficient_kit(const std::vector<AeroEquation>& equations) {
  constexpr double always = 1.0;
  const Variable one("one", "1", -infinity, infinity, always);
  EffectKit kit;
  for (std::size_t j = 0; j < equations.size(); ++j) {
    kit.ports.push_back({.name = equations[j].coefficient,
                         .unit = "1",
                         .components = {{.name = "s", .shares = {{static_cast<int>(j), one}}}},
                         .constant_is_own = false,
                         .lines = equations[j].regressors});
  }
  return kit;
}

bool has_regressor(const AeroEquation& equation, const std::string& effect) {
  return std::ranges::any_of(equation.regressors, [&](const std::string& regressor) {
    return effect == fmt::format("{}[{}]", equation.coefficient, regressor);
  });
}

std::vector<std::string> list_regressors(const std::vector<AeroEquation>& equations,
                                         const Record& record, const Flight& flight) {
  std::vector<std::string> channels{"time"};
  for (const std::string& name : record.names()) {
    if (flight.find(name) != nullptr && can_name(name)) channels.push_back(name);
  }
  std::vector<std::string> names;
  for (const AeroEquation& equation : equations) {
    const auto offer = [&](const std::string& regressor) {
      const std::string name = fmt::format("{}[{}]", equation.coefficient, regressor);
      if (!has_regressor(equation, name)) names.push_back(name);
    };
    for (const std::string& regressor : usual_regressors(equation.coefficient)) offer(regressor);
    for (const std::string& channel : channels) offer(channel);
  }
  return names;
}

std::vector<std::string> products_among(std::vector<std::string> names) {
  std::erase_if(names, is_spline);
  return names;
}

std::vector<std::string> usual_regressors(const std::string& coefficient) {
  const bool symmetric = coefficient == "CX" || coefficient == "CZ" || coefficient == "Cm";
  return symmetric ? of_symmetric_flow : of_sideslip;
}

std::string describe_regressor(const std::string& effect) {
  std::string sentence;
  for (const std::string& part : split_effects(effect)) {
    const EffectName name = parse_effect_name(part);
    sentence +=
        fmt::format("{}{} changes {}", sentence.empty() ? "" : ", and ",
                    meanings[find_coefficient(name.port)], catalogue::describe_driver(name));
  }
  return sentence;
}

}  // namespace sepcal::aircraft_log
