// SPDX-License-Identifier: BSD-3-Clause
// The choices among which a fit's options pick one, and their names: the same on the command line,
// in JSON and in Python.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <string>
#include <string_view>

#include "sepcal/error.hpp"

namespace sepcal {

/// How stage one looks for minima of Tr[R].
enum class Search {
  sampling,  // samples of xi2 within the bounds; descents from the deepest basins among them
  global,    // NLopt: a global search over the profile cost, then local ones from what it met
};

/// How stage one spreads its samples of xi2 within the bounds.
enum class Sampling {
  uniform,          // independent draws; normal where options.sampling_distribution names one
  low_discrepancy,  // a Halton sequence, shifted at random: fills the box more evenly
};

enum class SecondStage {
  automatic,  // the paper's Step 5: projected where stage one saw a unique minimum or a start was
              // given, else joint. Where projected does not converge, or from a given start ends
              // where the record leaves something open, joint from the same start
  joint,      // over (xi1, xi2)
  projected,  // over xi2, xi1 solved inside (variable projection)
};

/// The Jacobian of the projected residual.
enum class ProjectedJacobian {
  kaufman,        // without the derivative of the projector acting on the residual
  golub_pereyra,  // with it: n_1 + 1 evaluations of the model's tangent instead of one
};

/// What a whitened residual s costs; k is FitOptions::loss_width.
enum class Loss {
  squares,  // s^2
  huber,    // s^2 up to k, then 2 k |s| - k^2: outliers pull with a constant force
  cauchy,   // k^2 ln(1 + s^2 / k^2): the farther an outlier lies, the less it pulls
};

/// What a model with a state takes the residual for.
enum class FitMethod {
  output_error,  // noise of the outputs alone: states are integrated
  filter_error,  // noise that drives the states too: the likelihood of a filter's innovations, with
                 // the noises' sizes among what is estimated
};

/// What filter error's standard errors and last steps come from.
enum class Hessian {
  fisher,    // the expected one, of the score's rows
  observed,  // differences of the gradient, where that is positive definite (Newton-Raphson)
};

template <class Choice>
struct ChoiceNames;

template <>
struct ChoiceNames<Search> {
  static constexpr std::array<std::string_view, 2> names{"sampling", "global"};
};
template <>
struct ChoiceNames<Sampling> {
  static constexpr std::array<std::string_view, 2> names{"uniform", "low_discrepancy"};
};
template <>
struct ChoiceNames<SecondStage> {
  static constexpr std::array<std::string_view, 3> names{"auto", "joint", "projected"};
};
template <>
struct ChoiceNames<ProjectedJacobian> {
  static constexpr std::array<std::string_view, 2> names{"kaufman", "golub_pereyra"};
};
template <>
struct ChoiceNames<Loss> {
  static constexpr std::array<std::string_view, 3> names{"squares", "huber", "cauchy"};
};

template <>
struct ChoiceNames<FitMethod> {
  static constexpr std::array<std::string_view, 2> names{"output-error", "filter-error"};
};
template <>
struct ChoiceNames<Hessian> {
  static constexpr std::array<std::string_view, 2> names{"fisher", "observed"};
};

template <class T>
concept NamedChoice = requires {
  { ChoiceNames<T>::names.size() } -> std::convertible_to<std::size_t>;
};

template <NamedChoice T>
constexpr std::string_view to_string(T choice) {
  return ChoiceNames<T>::names[static_cast<std::size_t>(choice)];
}

/// The choice of that name. Throws Error that opens with `option` and lists the names.
template <NamedChoice T>
T choice_of(const std::string& option, std::string_view name) {
  const auto& names = ChoiceNames<T>::names;
  const auto at = std::ranges::find(names, name);
  if (at != names.end()) return static_cast<T>(at - names.begin());
  std::string known;
  for (const std::string_view each : names) {
    known += (known.empty() ? "'" : ", '") + std::string(each) + "'";
  }
  throw Error(option + " '" + std::string(name) + "' is unknown; known: " + known);
}

}  // namespace sepcal
