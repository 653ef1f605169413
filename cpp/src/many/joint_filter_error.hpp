// SPDX-License-Identifier: BSD-3-Clause
// Many flights by filter error: V_m of all of them over their own and the shared parameters and the
// sizes of the noises, which are shared.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "estimation/problem.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal::many {

/// The flights that take part, which were asked already.
struct UsedFlights {
  std::vector<std::size_t> places;  // in the source
  std::vector<std::string> names;
  std::vector<FlightStart> starts;
};

/// Fills `result` but for the flights left out.
void fit_joint_filter_error(const BlockModel& model, const estimation::Problem& problem,
                            const ManyOptions& options, FlightSource& source, UsedFlights flights,
                            ManyFit& result);

}  // namespace sepcal::many
