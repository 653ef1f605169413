// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/tables.hpp"

#include <algorithm>

#include <set>

#include "sepcal/error.hpp"

namespace sepcal {
namespace {

void check_unique(const std::vector<Variable>& variables, const std::string& what) {
  std::set<std::string> seen;
  for (const Variable& variable : variables) {
    if (variable.name.empty()) throw Error("a model's " + what + " has an empty name; give it one");
    if (!seen.insert(variable.name).second) {
      throw Error("a model has two " + what + "s named '" + variable.name + "'; rename one");
    }
  }
}

}  // namespace

std::vector<Variable> Tables::parameters() const {
  std::vector<Variable> all = linear;
  all.insert(all.end(), nonlinear.begin(), nonlinear.end());
  return all;
}

void Tables::check_names() const {
  check_unique(inputs, "input");
  check_unique(outputs, "output");
  check_unique(parameters(), "parameter");
}

std::string Tables::output_unit() const {
  const bool one = std::ranges::all_of(
      outputs, [&](const Variable& output) { return output.unit == outputs.front().unit; });
  return one && !outputs.empty() ? outputs.front().unit : "";
}

}  // namespace sepcal
