// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/time_text.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <string>

namespace sepcal::files {
namespace {

constexpr double minute = 60.0;
constexpr double hour = 3600.0;

std::string_view trim(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

/// Takes the digits that `text` begins with, up to `most` of them.
std::optional<int> take_digits(std::string_view& text, std::size_t most) {
  constexpr int ten = 10;
  const std::size_t count = std::min({text.find_first_not_of("0123456789"), text.size(), most});
  if (count == 0) return std::nullopt;
  int value = 0;
  for (const char digit : text.substr(0, count)) value = ten * value + (digit - '0');
  text.remove_prefix(count);
  return value;
}

bool take(std::string_view& text, std::string_view mark) {
  if (!text.starts_with(mark)) return false;
  text.remove_prefix(mark.size());
  return true;
}

/// Takes ".25" or ",25"; zero where there is no such.
std::optional<double> take_fraction(std::string_view& text) {
  if (text.empty() || (text.front() != '.' && text.front() != ',')) return 0.0;
  const auto after = text.find_first_not_of("0123456789", 1);
  std::string digits(text.substr(0, after));
  digits.front() = '.';
  double fraction = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), fraction);
  if (digits.size() < 2 || error != std::errc{}) return std::nullopt;
  text.remove_prefix(digits.size());
  return fraction;
}

/// Takes "PM": hours to add to what a 12-hour clock shows.
double take_half_day(std::string_view& text, int hours) {
  std::string half(trim(text).substr(0, 2));
  std::ranges::transform(half, half.begin(), [](unsigned char c) { return std::tolower(c); });
  if (half != "am" && half != "pm") return 0.0;
  text = trim(text).substr(2);
  if (half == "pm" && hours < 12) return 12.0;
  return half == "am" && hours == 12 ? -12.0 : 0.0;
}

/// Takes "162:" of a day of the year before a clock: seconds since the year's first day began.
double take_day_of_year(std::string_view& text) {
  constexpr std::size_t digits = 3;
  if (text.find_first_not_of("0123456789") != digits || text[digits] != ':') return 0.0;
  const int day_of_year = take_digits(text, digits).value_or(1);
  text.remove_prefix(1);
  return (day_of_year - 1) * 24.0 * hour;
}

/// Takes ".25", ",25" or, after a clock's colon, ":250".
std::optional<double> take_fraction_of_second(std::string_view& text) {
  constexpr double milli = 1e-3;
  if (!take(text, ":")) return take_fraction(text);
  if (text.find_first_not_of("0123456789") < 3) return std::nullopt;
  const auto milliseconds = take_digits(text, 3);
  return milliseconds ? std::optional(milli * *milliseconds) : std::nullopt;
}

/// Whether it begins as "10.14.30.0": two digits thrice and a fraction, which no date has.
bool has_clock_of_points(std::string_view text) {
  constexpr std::string_view form = "00.00.00.0";
  return text.size() >= form.size() &&
         std::ranges::equal(text.substr(0, form.size()), form, [](unsigned char c, char shape) {
           return shape == '.' ? c == '.' : std::isdigit(c) != 0;
         });
}

/// Takes a time of day; the rest is left.
std::optional<double> take_clock(std::string_view& text) {
  if (has_clock_of_points(text)) {
    const auto take_part = [&] {
      const int part = take_digits(text, 2).value_or(0);
      take(text, ".");
      return part;
    };
    const int hours = take_part();
    const int minutes = take_part();
    const int seconds = take_digits(text, 2).value_or(0);  // the fraction follows
    const auto fraction = take_fraction(text);
    if (!fraction || hours >= 24 || minutes >= 60 || seconds > 60) return std::nullopt;
    return hours * hour + minutes * minute + seconds + *fraction;
  }
  const double days = take_day_of_year(text);
  const auto first = take_digits(text, 2);
  if (!first || !take(text, ":")) return std::nullopt;
  const auto second = take_digits(text, 2);
  if (!second) return std::nullopt;
  if (!take(text, ":")) {
    const bool is_hours = text.empty() || (text.front() != '.' && text.front() != ',');
    const auto fraction = take_fraction(text);
    if (!fraction || *second >= 60) return std::nullopt;
    if (!is_hours) return *first * minute + *second + *fraction;
    return (*first + take_half_day(text, *first)) * hour + *second * minute;
  }
  const auto seconds = take_digits(text, 2);
  if (!seconds || *second >= 60 || *seconds > 60) return std::nullopt;
  const auto fraction = take_fraction_of_second(text);
  if (!fraction) return std::nullopt;
  const double hours = *first + take_half_day(text, *first);
  return days + hours * hour + *second * minute + *seconds + *fraction;
}

/// Takes "May" or "may.": 5; nothing where no name of a month stands.
std::optional<int> take_month_name(std::string_view& text) {
  constexpr std::array names{"jan", "feb", "mar", "apr", "may", "jun",
                             "jul", "aug", "sep", "oct", "nov", "dec"};
  std::string word(text.substr(0, 3));
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
  const auto found = std::ranges::find(names, word);
  if (found == names.end()) return std::nullopt;
  const auto after = std::ranges::find_if_not(
      text, [](unsigned char c) { return std::isalpha(c) != 0 || c == '.'; });
  text.remove_prefix(static_cast<std::size_t>(after - text.begin()));
  return static_cast<int>(found - names.begin()) + 1;
}

std::optional<double> days_since_1970(int year, int month, int day_of_month) {
  if (year < 100) year += year < 70 ? 2000 : 1900;
  const std::chrono::year_month_day date(std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day_of_month)));
  if (!date.ok() || year > 9999) return std::nullopt;
  return static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

bool take_date_mark(std::string_view& text) {
  return take(text, "-") || take(text, "/") || take(text, ".") || take(text, " ");
}

/// Takes a date; the rest is left.
std::optional<double> take_date(std::string_view& text, DateOrder order) {
  constexpr std::size_t compact = 8;              // 20240503
  constexpr std::size_t compact_with_clock = 14;  // 20240503100000
  const auto digits = std::min(text.find_first_not_of("0123456789"), text.size());
  if (digits == compact || digits == compact_with_clock) {
    const int year = take_digits(text, 4).value_or(0);
    const int month = take_digits(text, 2).value_or(0);
    return days_since_1970(year, month, take_digits(text, 2).value_or(0));
  }
  const bool year_first = digits == 4;
  const auto first = take_digits(text, 4);
  if (!first || !take_date_mark(text)) return std::nullopt;
  const auto name = take_month_name(text);
  const auto second = name ? name : take_digits(text, 2);
  if (!second || !take_date_mark(text)) return std::nullopt;
  const auto third = take_digits(text, 4);
  if (!third) return std::nullopt;
  if (year_first) return days_since_1970(*first, *second, *third);
  const bool day_first = name || order == DateOrder::day_first;
  return day_first ? days_since_1970(*third, *second, *first)
                   : days_since_1970(*third, *first, *second);
}

/// Takes "Z", "UTC" or "+02:00": seconds that the clock is ahead.
std::optional<double> take_zone(std::string_view& text) {
  text = trim(text);
  if (take(text, "Z") || take(text, "UTC") || take(text, "GMT")) return 0.0;
  const double sign = text.starts_with('-') ? -1.0 : 1.0;
  if (!take(text, "+") && !take(text, "-")) return 0.0;
  const auto hours = take_digits(text, 2);
  take(text, ":");
  const auto minutes = text.empty() ? std::optional(0) : take_digits(text, 2);
  if (!hours || !minutes) return std::nullopt;
  return sign * (*hours * hour + *minutes * minute);
}

}  // namespace

std::optional<double> parse_clock(std::string_view text) {
  text = trim(text);
  const auto seconds = take_clock(text);
  if (!seconds || !take_zone(text) || !text.empty()) return std::nullopt;
  return seconds;
}

std::optional<double> parse_date(std::string_view text, DateOrder order) {
  text = trim(text);
  const auto days = take_date(text, order);
  return text.empty() ? days : std::nullopt;
}

std::optional<DateTime> parse_date_time(std::string_view text, DateOrder order) {
  text = trim(text);
  const auto days = take_date(text, order);
  if (!days || text.empty()) return std::nullopt;
  if (!take(text, "T") && !take(text, "t") && !take(text, ",")) take(text, " ");
  text = trim(text);
  std::string compact;  // 100000.2
  if (text.size() >= 6 && text.find(':') > 6 &&
      std::all_of(text.begin(), text.begin() + 6,
                  [](unsigned char c) { return std::isdigit(c); })) {
    compact = std::string(text.substr(0, 2)) + ":" + std::string(text.substr(2, 2)) + ":" +
              std::string(text.substr(4));
    text = compact;
  }
  const auto seconds = take_clock(text);
  const auto ahead = take_zone(text);
  if (!seconds || !ahead || !text.empty()) return std::nullopt;
  return DateTime{*days, *seconds - *ahead};
}

}  // namespace sepcal::files
