// SPDX-License-Identifier: BSD-3-Clause
#include "many/split.hpp"

#include <algorithm>

#include "base/name_list.hpp"
#include "sepcal/error.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;

void check_own(const estimation::Problem& problem, const std::vector<std::string>& own) {
  for (auto name = own.begin(); name != own.end(); ++name) {
    if (std::ranges::find(problem.parameters(), *name, &Variable::name) ==
        problem.parameters().end()) {
      const bool fixed = problem.options().fix.contains(*name);
      throw Error(fixed ? "own '" + *name + "' is fixed, and so the same in every flight; free it" +
                              " or leave it out of own"
                        : "own: there is no parameter '" + *name +
                              "'; the model has: " + base::list_names(problem.parameters()));
    }
    if (std::find(own.begin(), name, *name) != name) {
      throw Error("own: '" + *name + "' stands there twice; leave one out");
    }
  }
}

}  // namespace

std::vector<Index> Split::order() const {
  std::vector<Index> order = own;
  order.insert(order.end(), shared.begin(), shared.end());
  return order;
}

Split split(const estimation::Problem& problem, const std::vector<std::string>& own) {
  check_own(problem, own);
  Split split;
  for (std::size_t k = 0; k < problem.parameters().size(); ++k) {
    const bool is_own = std::ranges::find(own, problem.parameters()[k].name) != own.end();
    (is_own ? split.own : split.shared).push_back(static_cast<Index>(k));
  }
  if (split.shared.empty()) {
    throw Error(
        "every parameter is the flight's own, so that nothing joins the flights; leave a "
        "parameter out of own, or fit each flight by itself");
  }
  return split;
}

Split split_with_noises(const estimation::Problem& problem, const std::vector<std::string>& own,
                        Index noises) {
  Split parting = split(problem, own);
  const auto first = static_cast<Index>(problem.parameters().size());
  for (Index k = 0; k < noises; ++k) parting.shared.push_back(first + k);
  return parting;
}

std::vector<Variable> variables(const estimation::Problem& problem, const Split& split) {
  std::vector<Variable> variables;
  for (const Index k : split.order()) {
    variables.push_back(problem.parameters()[static_cast<std::size_t>(k)]);
  }
  return variables;
}

}  // namespace sepcal::many
