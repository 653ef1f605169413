// SPDX-License-Identifier: BSD-3-Clause
#include "base/name_list.hpp"

namespace sepcal::base {

std::string list_names(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

std::string list_names(const std::vector<Variable>& variables) {
  std::vector<std::string> names;
  for (const Variable& variable : variables) names.push_back(variable.name);
  return list_names(names);
}

}  // namespace sepcal::base
