// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/aircraft/equations.hpp"

#include <algorithm>
#include <set>

#include "base/name_list.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

constexpr std::array<std::string_view, 5> angles{"alpha", "beta", "elevator", "aileron", "rudder"};
constexpr std::array<std::string_view, 3> rates{"p_hat", "q_hat", "r_hat"};

[[noreturn]] void refuse(std::string_view text) {
  throw Error("the regressor '" + std::string(text) +
              "' can't be read; write 1, x, x^2 to x^9, abs(x) or a product of these, as alpha^2 "
              "or beta*abs(beta)");
}

template <class List>
bool has(const List& list, std::string_view name) {
  return std::ranges::find(list, name) != list.end();
}

}  // namespace

std::size_t find_coefficient(std::string_view name) {
  const auto at = std::ranges::find(coefficient_names, name);
  if (at == coefficient_names.end()) {
    throw Error("there is no coefficient '" + std::string(name) +
                "'; the aircraft has CX, CY, CZ, Cl, Cm, Cn");
  }
  return static_cast<std::size_t>(at - coefficient_names.begin());
}

Regressor::Regressor(std::string text) : text_(std::move(text)) {
  if (text_ == "1") return;
  auto factors = read_product(text_);
  if (!factors) refuse(text_);
  factors_ = *std::move(factors);
}

std::vector<AeroEquation> standard_equations(const std::vector<std::string>& coefficients) {
  std::vector<AeroEquation> all{{"CX", {"1", "alpha", "alpha^2", "q_hat", "elevator"}},
                                {"CY", {"1", "beta", "p_hat", "r_hat", "aileron", "rudder"}},
                                {"CZ", {"1", "alpha", "q_hat", "elevator"}},
                                {"Cl", {"1", "beta", "p_hat", "r_hat", "aileron", "rudder"}},
                                {"Cm", {"1", "alpha", "q_hat", "elevator"}},
                                {"Cn", {"1", "beta", "p_hat", "r_hat", "aileron", "rudder"}}};
  if (coefficients.empty()) return all;
  std::vector<AeroEquation> chosen;
  for (const std::string& name : coefficients) chosen.push_back(all[find_coefficient(name)]);
  return chosen;
}

std::vector<AeroEquation> complete_equations(std::vector<AeroEquation> equations,
                                             const std::vector<std::string>& coefficients) {
  for (AeroEquation& standard : standard_equations(coefficients)) {
    const auto at = std::ranges::find(equations, standard.coefficient, &AeroEquation::coefficient);
    if (at == equations.end()) equations.push_back(std::move(standard));
  }
  return equations;
}

std::string parameter_name(std::string_view coefficient, std::string_view regressor) {
  std::string name = std::string(coefficient) + "_";
  if (regressor == "1") return name + "0";
  if (has(rates, regressor)) regressor = regressor.substr(0, 1);
  return name + std::string(regressor);
}

std::string parameter_unit(const Regressor& regressor) {
  int radians = 0;
  std::string others;
  for (const ChannelFactor& factor : regressor.factors()) {
    if (has(angles, factor.channel)) {
      radians += factor.power;
    } else if (!has(rates, factor.channel)) {
      others += "/" + factor.channel;
      if (factor.power > 1) others += "^" + std::to_string(factor.power);
    }
  }
  if (radians == 0) return "1" + others;
  return "1/rad" + (radians > 1 ? "^" + std::to_string(radians) : "") + others;
}

std::vector<std::string> variables_of(const std::vector<AeroEquation>& equations) {
  std::vector<std::string> variables;
  for (const AeroEquation& equation : equations) {
    for (const std::string& text : equation.regressors) {
      const Regressor regressor(text);
      for (const ChannelFactor& factor : regressor.factors()) {
        if (!has(variables, factor.channel)) variables.push_back(factor.channel);
      }
    }
  }
  return variables;
}

void check_equations(const std::vector<AeroEquation>& equations) {
  if (equations.empty()) throw Error("no coefficient is asked for; name one of CX ... Cn");
  std::set<std::string> seen;
  for (const AeroEquation& equation : equations) {
    find_coefficient(equation.coefficient);
    if (!seen.insert(equation.coefficient).second) {
      throw Error(equation.coefficient + " has two equations; put all regressors into one");
    }
    if (equation.regressors.empty()) {
      throw Error(equation.coefficient + " has no regressors; give at least \"1\"");
    }
    std::set<std::string> regressors;
    for (const std::string& text : equation.regressors) {
      if (regressors.insert(Regressor(text).text()).second) continue;
      throw Error("the regressor '" + text + "' of " + equation.coefficient + " stands twice");
    }
  }
}

}  // namespace sepcal
