// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <string_view>

#include "base/page.hpp"
#include "base/sentences.hpp"
#include "flight/text/number_text.hpp"
#include "flight/text/status_text.hpp"
#include "sepcal/flight/intervals.hpp"

namespace sepcal {

using base::Page;
using base::page;

namespace {

Page end_of(double value) { return text::defined(value, "{:.6g}"); }

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
    return what.empty() ? "" : page("{}: {}", side, what).text();
  };
  return base::join_sentences({remark("lower", remark_on(interval.lower_end)),
                               remark("upper", remark_on(interval.upper_end))});
}

Page interval_table(const std::vector<ProfileInterval>& parameters, double level) {
  std::size_t name = 14;
  std::size_t unit = 5;
  for (const ProfileInterval& interval : parameters) {
    name = std::max(name, interval.name.size());
    unit = std::max(unit, interval.unit.size());
  }
  const double percent = 100.0 * level;
  Page text = page("{:<{}} {:>13} {:>27} {:>27}  unit", "parameter", name, "value",
                   page("{:g} % Gaussian", percent), page("{:g} % profile", percent))
                  .trimmed() +
              "\n";
  Page messages;
  for (const ProfileInterval& interval : parameters) {
    text += page("{:<{}} {:>13} {:>13} {:>13} {:>13} {:>13}  {:<{}} {}", interval.name, name,
                 end_of(interval.value), end_of(interval.gaussian.lower),
                 end_of(interval.gaussian.upper), end_of(interval.profile.lower),
                 end_of(interval.profile.upper), interval.unit, unit, remark_on(interval))
                .trimmed() +
            "\n";
    if (!interval.message.empty()) {
      messages += page("{}: {}\n", interval.name, interval.message);
    }
  }
  return messages.empty() ? text : text + "\n" + messages;
}

}  // namespace

std::string to_text(const FlightIntervals& intervals, Detail detail) {
  const Page text =
      page("{}: {} of {} rows of {}\n", intervals.model, intervals.flight.rows_used,
           intervals.flight.rows, intervals.flight.file) +
      text::status_lines(intervals.status, intervals.at_bound, intervals.message, detail) + "\n" +
      interval_table(intervals.parameters, intervals.level);
  return text.text();
}

std::string to_text(const std::vector<ProfileInterval>& parameters, double level) {
  return interval_table(parameters, level).text();
}

}  // namespace sepcal
