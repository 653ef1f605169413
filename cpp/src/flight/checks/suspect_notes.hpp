// SPDX-License-Identifier: BSD-3-Clause
// What a person should know of columns with rows that are no readings, and the way out.
#pragma once

#include "flight/checks/suspects.hpp"
#include "sepcal/detail/flight/log_choice.hpp"

namespace sepcal::checks {

/// A note for each column and kind; bursts of the same rows are one. `choice`: what was chosen
/// already, which a condition to type goes on from.
void check_suspects(const Log& log, const std::vector<SuspectColumn>& suspects,
                    const LogChoice& choice, std::vector<LogNote>& notes);

/// Readings that are one value throughout: mx_ut and its like, an airspeed, a pressure, where it is
/// not zero an acceleration, a rate or a flow angle; and a
/// velocity of which the other component moves.
void check_constants(const Log& log, std::vector<LogNote>& notes);

/// The conditions and what was chosen before, as one.
std::string join_conditions(const std::string& where, std::vector<std::string> conditions);

}  // namespace sepcal::checks
