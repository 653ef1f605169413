// SPDX-License-Identifier: BSD-3-Clause
// A log's columns under sepcal's names, where its own say the same.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::logs {

/// Renames columns that no exact header names and that clearly are a known quantity in a unit that
/// is spelled, "GPS_VN (m/s)" to vn_mps, where the quantity is not there already and one column is
/// nearer to its name than all others. One note lists what was taken. A slip of a letter is never
/// taken, nor a unit guessed.
void name_columns(Flight& flight, std::vector<std::string>& notes);

}  // namespace sepcal::logs
