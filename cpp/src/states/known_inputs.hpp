// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sepcal/detail/tables.hpp"
#include "sepcal/record.hpp"

namespace sepcal::states {

/// Throws Error for an input that isn't finite in some row of the record's segments.
void check_inputs(const Tables& tables, const Record& record);

}  // namespace sepcal::states
