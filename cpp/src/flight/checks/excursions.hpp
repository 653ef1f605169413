// SPDX-License-Identifier: BSD-3-Clause
// Readings that jump away from those beside them and come back: one alone, or some in a row.
#pragma once

#include "flight/checks/suspect_rows.hpp"

namespace sepcal::checks {

struct Excursions {
  RowList spikes;  // rows of single readings
  RowList bursts;  // rows of two to thirty readings in a row
  double farthest_spike = 0.0;
  double spike_share = 0.0;  // of the squares of all that readings differ from their neighbours
  double farthest_burst = 0.0;
};

/// Robust standard deviation of new readings about those beside them; NaN of fewer than 200, of
/// which what is usual can't be told.
double reading_noise(std::span<const double> values, const std::vector<Segment>& stretches);

/// Of fewer than 200 readings, none. Bursts are looked for in a column that flows.
Excursions find_excursions(std::span<const double> values, const std::vector<Segment>& stretches,
                           const Manner& manner);

}  // namespace sepcal::checks
