// SPDX-License-Identifier: BSD-3-Clause
// A log's columns under the names that a choice gives them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sepcal/detail/flight/log_choice.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// The column that a map reads, as it stands or with the other sign: "my_ut", "-my_ut".
struct MappedColumn {
  std::string header;
  bool is_negated = false;
};

/// Nothing where the flight has neither that column nor, after a minus, that one.
std::optional<MappedColumn> find_mapped(const Flight& flight, const std::string& logged);

/// Renames the columns that `choice.map` names, all at once, so that two may change places, and
/// turns the sign of those with a minus; then drops those in `choice.ignore`, by the log's header
/// or the new one. A note says where the axes of a vector come out mirrored. Throws OptionError for
/// a column that is not there or is read twice, and for a new name that another column has.
void choose_columns(Flight& flight, const LogChoice& choice, std::vector<std::string>& notes);

}  // namespace sepcal::logs
