// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/sentences.hpp"
#include "flight/text/status_text.hpp"
#include "sepcal/flight/intervals.hpp"

namespace sepcal {
namespace {

std::string end_of(double value) { return std::isnan(value) ? "-" : fmt::format("{:.6g}", value); }

/// What ends the profile interval on a side, where it isn't the data.
std::string_view remark_on(IntervalEnd end) {
  switch (end) {
    case IntervalEnd::bound:
      return "its bound ends it";
    case IntervalEnd::open:
      return "open";
    case IntervalEnd::failed:
      return "could not be found";
    default:
      return "";
  }
}

std::string remark_on(const ProfileInterval& interval) {
  const auto remark = [](std::string_view side, std::string_view what) {
    return what.empty() ? "" : fmt::format("{}: {}", side, what);
  };
  return base::join_sentences({remark("lower", remark_on(interval.lower_end)),
                               remark("upper", remark_on(interval.upper_end))});
}

}  // namespace

std::string to_text(const FlightIntervals& intervals, Detail detail) {
  return fmt::format("{}: {} of {} rows of {}\n", intervals.model, intervals.flight.rows_used,
                     intervals.flight.rows, intervals.flight.file) +
         text::status_lines(intervals.status, intervals.at_bound, intervals.message, detail) +
         "\n" + to_text(intervals.parameters, intervals.level);
}

std::string to_text(const std::vector<ProfileInterval>& parameters, double level) {
  std::size_t name = 14;
  std::size_t unit = 5;
  for (const ProfileInterval& interval : parameters) {
    name = std::max(name, interval.name.size());
    unit = std::max(unit, interval.unit.size());
  }
  const auto trimmed = [](const std::string& row) {
    return row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  };
  const double percent = 100.0 * level;
  std::string text = trimmed(fmt::format("{:<{}} {:>13} {:>27} {:>27}  unit", "parameter", name,
                                         "value", fmt::format("{:g} % Gaussian", percent),
                                         fmt::format("{:g} % profile", percent)));
  std::string messages;
  for (const ProfileInterval& interval : parameters) {
    text += trimmed(fmt::format("{:<{}} {:>13} {:>13} {:>13} {:>13} {:>13}  {:<{}} {}",
                                interval.name, name, end_of(interval.value),
                                end_of(interval.gaussian.lower), end_of(interval.gaussian.upper),
                                end_of(interval.profile.lower), end_of(interval.profile.upper),
                                interval.unit, unit, remark_on(interval)));
    if (!interval.message.empty()) {
      messages += fmt::format("{}: {}\n", interval.name, interval.message);
    }
  }
  return messages.empty() ? text : text + "\n" + messages;
}

}  // namespace sepcal
