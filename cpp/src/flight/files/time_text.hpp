// SPDX-License-Identifier: BSD-3-Clause
// Time as logs write it in text: of day, dates, and both in one cell (ISO 8601 and what is near).
#pragma once

#include <optional>
#include <string_view>

namespace sepcal::files {

/// "10:00:00.200", "9:05", "12:34.5" (minutes and seconds), "1:02:03 PM": seconds since midnight.
std::optional<double> parse_clock(std::string_view text);

/// Which part of "03/05/2024" is the day.
enum class DateOrder { year_first, day_first, month_first };

/// "2024-05-03", "3.5.2024", "20240503", "03-May-2024": days since 1970-01-01. A name of a month
/// and a year in front are read in any order.
std::optional<double> parse_date(std::string_view text, DateOrder order);

struct DateTime {
  double days = 0.0;     // since 1970-01-01
  double seconds = 0.0;  // since that midnight; before it, or after the next, where a zone is ahead
};

/// A date, a blank or "T", and a time of day, perhaps with a zone ("Z", "UTC", "+02:00"): in UTC,
/// or in the clock's own zone where it names none.
std::optional<DateTime> parse_date_time(std::string_view text, DateOrder order);

}  // namespace sepcal::files
