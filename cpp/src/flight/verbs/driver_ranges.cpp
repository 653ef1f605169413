// SPDX-License-Identifier: BSD-3-Clause
#include "flight/verbs/driver_ranges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "flight/catalogue/effect_channels.hpp"

namespace sepcal::verbs {
namespace {

Interval range_of(const Record& record, const std::string& channel) {
  const std::span<const double> column = record.column(channel);
  Interval range{infinity, -infinity};
  for (const Segment& segment : record.segments()) {
    for (const double value : column.subspan(segment.first, segment.rows())) {
      range.lower = std::min(range.lower, value);
      range.upper = std::max(range.upper, value);
    }
  }
  return range;
}

}  // namespace

std::map<std::string, Interval> ranges_of_drivers(const Probe& probe,
                                                  const std::vector<EffectSetting>& settings,
                                                  const Record& record) {
  const catalogue::EffectTable& table = probe.effects();
  std::map<std::string, Interval> ranges;
  for (const EffectSetting& setting : settings) {
    const EffectName name = parse_effect_name(setting.name);
    if (catalogue::acts_on_the_world(table, name)) continue;
    const catalogue::EffectRow* const own = table.find_effect(name.text);
    for (const std::string& channel : own != nullptr ? own->channels : driver_channels(name)) {
      if (channel == "time" || channel == "maneuver" || !record.has(channel)) continue;
      const Interval range = range_of(record, channel);
      if (range.lower <= range.upper) ranges[channel] = range;
    }
  }
  return ranges;
}

void note_beyond(const std::map<std::string, Interval>& ranges, const Record& record,
                 std::vector<std::string>& notes) {
  constexpr double allowed = 0.1;
  for (const auto& [channel, seen] : ranges) {
    if (!record.has(channel)) continue;
    const double margin = allowed * (seen.upper - seen.lower);
    const auto is_beyond = [&](double value) {
      return value < seen.lower - margin || value > seen.upper + margin;
    };
    const std::span<const double> values = record.column(channel);
    const auto beyond = std::ranges::count_if(values, is_beyond);
    if (beyond == 0) continue;
    notes.push_back(fmt::format(
        "{} of {} rows have {} beyond {:.4g} to {:.4g}, which the fit saw: what follows it is a "
        "guess there",
        beyond, values.size(), channel, seen.lower, seen.upper));
  }
}

}  // namespace sepcal::verbs
