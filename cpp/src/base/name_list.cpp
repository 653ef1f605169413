// SPDX-License-Identifier: BSD-3-Clause
#include "base/name_list.hpp"

#include <algorithm>

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

std::string list_first(const std::vector<std::string>& names, std::size_t most) {
  if (names.size() <= most) return list_names(names);
  const auto end = names.begin() + static_cast<std::ptrdiff_t>(most);
  return list_names(std::vector<std::string>(names.begin(), end)) + " and " +
         std::to_string(names.size() - most) + " more";
}

bool is_among(const std::vector<std::string>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace sepcal::base
