// SPDX-License-Identifier: BSD-3-Clause
// A log whose quantities were logged at different times, with all of them in the rows of what the
// model measures.
#pragma once

#include "flight/probes/quantities.hpp"
#include "sepcal/detail/flight/read_as.hpp"

namespace sepcal::probes {

/// read_as(), and where `choice.join` says how: every other column brought to the rows in which all
/// that is measured was logged, or where no row has all of it, its first quantity. Throws
/// OptionError as read_as() does, of a model that measures no quantity of its own, and of a log
/// without a time or on disc.
ReadFlight read_for(const ModelQuantities& model, const Flight& flight, const LogChoice& choice);

/// Whether a row of read_for()'s flight has all that is measured; empty where nothing is joined.
logs::RowTruth rows_measured(std::span<const ProbeQuantity> quantities, const Flight& flight,
                             const LogChoice& choice);

}  // namespace sepcal::probes
