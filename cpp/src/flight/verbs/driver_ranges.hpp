// SPDX-License-Identifier: BSD-3-Clause
// Over which values a fit saw what its effects follow: beyond them a curve is a guess.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "sepcal/detail/named_effects.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal::verbs {

/// The least and the greatest value in the record's segments of each channel that an effect on the
/// reading follows, in the record's unit. `record` as the model with its effects takes it; time
/// and what the record lacks are left out.
std::map<std::string, Interval> ranges_of_drivers(const Probe& probe,
                                                  const std::vector<EffectSetting>& settings,
                                                  const Record& record);

/// Notes each driver that a log has further than a tenth of its range beyond what the fit saw.
void note_beyond(const std::map<std::string, Interval>& ranges, const Record& record,
                 std::vector<std::string>& notes);

}  // namespace sepcal::verbs
