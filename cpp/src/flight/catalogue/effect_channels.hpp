// SPDX-License-Identifier: BSD-3-Clause
// What effects read of a flight that a calibration is applied to, beside the readings themselves.
#pragma once

#include <string>
#include <vector>

#include "flight/catalogue/effect_table.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::catalogue {

/// Whether the record has a column that means something: body rates that are zero throughout stand
/// for rates that aren't logged.
bool is_logged(const Record& record, const std::string& name);

/// Effects on the world, which a reading is not corrected for.
bool acts_on_the_world(const EffectTable& table, const EffectName& name);

/// Adds the channels that an effect needs to a record of the flight's rows, each under its name in
/// a fit's record, and returns their names. Throws Error naming the effect and the channel where
/// the flight doesn't log it.
std::vector<std::string> add_channels(Record& record, const Flight& flight, const Probe& probe,
                                      const EffectName& effect);

/// Adds whatever the flight logs: an effect of the caller's own may read any of it.
void add_all_channels(Record& record, const Flight& flight);

}  // namespace sepcal::catalogue
