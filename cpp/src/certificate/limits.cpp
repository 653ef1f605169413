// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/limits.hpp"

#include <algorithm>
#include <cmath>

#include "base/name_list.hpp"
#include "sepcal/error.hpp"

namespace sepcal::certificate {

Limits limits_of(const Tables& tables, const std::map<std::string, Interval>& bounds) {
  const std::vector<Variable> all = tables.parameters();
  for (const auto& [name, range] : bounds) {
    if (std::ranges::find(all, name, &Variable::name) == all.end()) {
      throw Error("bounds: there is no parameter '" + name +
                  "'; the model has: " + base::list_names(all));
    }
    if (!(range.lower <= range.upper)) throw Error("bounds of '" + name + "' are no range");
  }
  const auto range_of = [&](const Variable& variable) {
    const auto own = bounds.find(variable.name);
    return own == bounds.end() ? Enclosure(variable.lower, variable.upper)
                               : Enclosure(own->second.lower, own->second.upper);
  };
  Limits limits;
  for (const Variable& variable : tables.linear) limits.linear.push_back(range_of(variable));
  for (const Variable& variable : tables.nonlinear) {
    limits.nonlinear.push_back(range_of(variable));
    if (!limits.nonlinear.back().is_finite()) {
      throw Error("'" + variable.name +
                  "' has no bounds, and nothing is proven of an endless box: give it bounds");
    }
  }
  return limits;
}

}  // namespace sepcal::certificate
