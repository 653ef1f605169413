// SPDX-License-Identifier: BSD-3-Clause
// The flight without what a choice of rows leaves out.
#pragma once

#include <string_view>

#include "flight/probes/quantities.hpp"
#include "sepcal/detail/flight/log_choice.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::checks {

/// Rows that are not taken keep their time alone.
struct TakenRows {
  Flight flight;
  std::vector<std::size_t> left_out = {};
};

/// Throws Error as probes::rows_taken().
TakenRows take_rows(const probes::ModelQuantities& model, const Flight& flight,
                    const LogChoice& choice);

}  // namespace sepcal::checks
