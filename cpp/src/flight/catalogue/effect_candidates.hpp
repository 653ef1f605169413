// SPDX-License-Identifier: BSD-3-Clause
// What could be missing from a probe's model on a flight, by name.
#pragma once

#include <string>
#include <vector>

#include "flight/catalogue/effect_table.hpp"
#include "sepcal/flight/flight.hpp"

namespace sepcal::catalogue {

/// Every effect of the kit and every port of the table with every channel of the record that the
/// flight logs under its own header, with time and with the state functions; smooth and curved ones
/// where physics is seldom straight.
std::vector<std::string> list_candidates(const EffectTable& table, const EffectKit& kit,
                                         const Record& record, const Flight& flight);

/// What of these may drive an effect: time, channels and state functions.
std::vector<std::string> list_drivers(const EffectTable& table, const Record& record,
                                      const Flight& flight);

/// Channels of effects that the flight doesn't log: "throttle".
std::vector<std::string> list_missing_channels(const EffectTable& table, const Flight& flight);

/// What an effect means, in plain words without its size: "the wind changes with altitude_m".
std::string describe_effect(const EffectTable& table, const std::string& name);

/// How it changes with its driver: "smoothly with altitude_m".
std::string describe_driver(const EffectName& name);

}  // namespace sepcal::catalogue
