// SPDX-License-Identifier: BSD-3-Clause
#include "aircraft/held.hpp"

#include "base/name_list.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

void aircraft::hold_at_zero(const std::vector<std::string>& held,
                            const std::vector<std::string>& free, FitOptions& fit) {
  for (const std::string& name : held) {
    if (!base::is_among(free, name)) fit.fix.emplace(name, 0.0);
  }
  for (const std::string& name : free) {
    if (base::is_among(held, name)) continue;
    throw Error("'" + name +
                "' is not held; those that may be freed are: " + base::list_names(held));
  }
}

}  // namespace sepcal
