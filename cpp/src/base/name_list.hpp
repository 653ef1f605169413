// SPDX-License-Identifier: BSD-3-Clause
// Names as messages list them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/tables.hpp"

namespace sepcal::base {

/// "a, b, c", or "none".
std::string list_names(const std::vector<std::string>& names);
std::string list_names(const std::vector<Variable>& variables);

/// "a, b and 7 more", with at most `most` of them.
std::string list_first(const std::vector<std::string>& names, std::size_t most);

/// The fewest slips: a letter inserted, deleted or replaced, or two neighbours swapped (the optimal
/// string alignment of Damerau).
std::size_t count_slips(std::string_view from, std::string_view to);

/// "; did you mean 'b'?" where one of the names is `name` but for so many slips, else "".
std::string ask_for_similar(std::string_view name, const std::vector<std::string>& names,
                            std::size_t most);

bool is_among(const std::vector<std::string>& names, std::string_view name);

}  // namespace sepcal::base
