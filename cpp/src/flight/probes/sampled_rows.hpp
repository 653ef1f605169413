// SPDX-License-Identifier: BSD-3-Clause
// The rows in which slow columns were sampled; in those between them the log holds or interpolates.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/flight.hpp"

namespace sepcal::probes {

/// Whether a column is called so: by its whole header, or by that without its unit.
bool is_called(const std::string& header, const std::string& name);

/// A row each: whether the slowest of the columns was sampled there, or another one that is about
/// as slow. `columns`: quantities ("airspeed") or
/// whole headers; `time` [s] a row each, or none. Throws Error for a column that is not there.
std::vector<bool> find_sampled(const Flight& flight, const std::vector<std::string>& columns,
                               const std::vector<double>& time);

}  // namespace sepcal::probes
