// SPDX-License-Identifier: BSD-3-Clause
// The rows of a log that a choice takes by what they hold and when they were logged.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "flight/files/headers.hpp"
#include "flight/logs/row_expression.hpp"
#include "sepcal/detail/flight/log_choice.hpp"

namespace sepcal::logs {

/// The probe's quantity by that name, in the unit used inside; nothing where it was not logged.
using FindQuantity = std::function<std::optional<files::LoggedQuantity>(const std::string& name)>;

/// Whether `choice.where` holds; empty where there is none. Names are whole headers, as logged, or
/// quantities, in the unit used inside or in one that their name ends with. Throws OptionError for
/// what is no condition, and for a name that is neither.
RowTruth rows_where(const Flight& flight, const LogChoice& choice, const FindQuantity& find);

/// Whether a row lies within `choice.from_time` and `choice.to_time`; empty where it has neither.
/// Throws OptionError where no time was logged, and for times that exclude each other.
RowTruth rows_within_times(const Flight& flight, const LogChoice& choice);

}  // namespace sepcal::logs
