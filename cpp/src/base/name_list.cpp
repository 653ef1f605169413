// SPDX-License-Identifier: BSD-3-Clause
#include "base/name_list.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

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

std::size_t count_slips(std::string_view from, std::string_view to) {
  std::vector<std::size_t> before(to.size() + 1);  // a letter earlier
  std::vector<std::size_t> above(to.size() + 1);
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::swap(before, above);
    std::swap(above, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t replaced = above[j] + (from[i] == to[j] ? 0 : 1);
      row[j + 1] = std::min({row[j] + 1, above[j + 1] + 1, replaced});
      const bool is_swap = i > 0 && j > 0 && from[i] == to[j - 1] && from[i - 1] == to[j];
      if (is_swap) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
  }
  return row.back();
}

std::string ask_for_similar(std::string_view name, const std::vector<std::string>& names,
                            std::size_t most) {
  std::size_t fewest = most + 1;
  std::string_view nearest;
  for (const std::string& known : names) {
    const std::size_t slips = count_slips(name, known);
    if (slips >= fewest) continue;
    fewest = slips;
    nearest = known;
  }
  return nearest.empty() ? "" : "; did you mean '" + std::string(nearest) + "'?";
}

}  // namespace sepcal::base
