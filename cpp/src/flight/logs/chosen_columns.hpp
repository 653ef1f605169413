// SPDX-License-Identifier: BSD-3-Clause
// A log's columns under the names that a choice gives them.
#pragma once

#include "sepcal/detail/flight/log_choice.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// Renames the columns that `choice.map` names, then drops those in `choice.ignore`, by the log's
/// header or the new one. Throws OptionError for a column that is not there, and for a new name
/// that another column has.
void choose_columns(Flight& flight, const LogChoice& choice);

}  // namespace sepcal::logs
