// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/aircraft/equations.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>

#include "base/name_list.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

constexpr int highest_power = 9;
constexpr std::array<std::string_view, 5> angles{"alpha", "beta", "elevator", "aileron", "rudder"};
constexpr std::array<std::string_view, 3> rates{"p_hat", "q_hat", "r_hat"};

bool is_name(std::string_view text) {
  const auto is_part = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  };
  return !text.empty() && std::ranges::all_of(text, is_part) &&
         std::isdigit(static_cast<unsigned char>(text.front())) == 0;
}

[[noreturn]] void refuse(std::string_view text) {
  throw Error("the regressor '" + std::string(text) +
              "' can't be read; write 1, x, x^2 to x^9, abs(x) or a product of these, as alpha^2 "
              "or beta*abs(beta)");
}

/// One factor of the product `whole`.
Regressor::Factor read_factor(std::string_view text, std::string_view whole) {
  Regressor::Factor factor;
  const std::size_t caret = text.find('^');
  if (caret != std::string_view::npos) {
    const std::string_view power = text.substr(caret + 1);
    const auto [end, error] =
        std::from_chars(power.data(), power.data() + power.size(), factor.power);
    const bool whole_number = error == std::errc{} && end == power.data() + power.size();
    if (!whole_number || factor.power < 1 || factor.power > highest_power) refuse(whole);
    text = text.substr(0, caret);
  }
  if (text.starts_with("abs(") && text.ends_with(')')) {
    factor.absolute = true;
    text = text.substr(4, text.size() - 5);
  }
  if (!is_name(text)) refuse(whole);
  factor.variable = std::string(text);
  return factor;
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
  for (std::size_t first = 0; first <= text_.size();) {
    const std::size_t star = std::min(text_.find('*', first), text_.size());
    factors_.push_back(read_factor(std::string_view(text_).substr(first, star - first), text_));
    first = star + 1;
  }
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
  for (const Regressor::Factor& factor : regressor.factors()) {
    if (has(angles, factor.variable)) {
      radians += factor.power;
    } else if (!has(rates, factor.variable)) {
      others += "/" + factor.variable;
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
      for (const Regressor::Factor& factor : regressor.factors()) {
        if (!has(variables, factor.variable)) variables.push_back(factor.variable);
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
