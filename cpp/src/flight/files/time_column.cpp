// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/time_column.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "flight/files/headers.hpp"
#include "flight/files/known_names.hpp"
#include "flight/files/number_text.hpp"
#include "flight/files/units.hpp"
#include "sepcal/error.hpp"

namespace sepcal::files {
namespace {

constexpr double day = 86400.0;
constexpr const char* time_header = "time_s";

bool is_time_word(const std::string& word) {
  constexpr std::array words{"time",  "timestamp", "t",     "utc",     "datetime",   "clock",
                             "epoch", "date",      "ts",    "stamp",   "datenum",    "elapsed",
                             "zeit",  "uhrzeit",   "temps", "heure",   "hora",       "tiempo",
                             "tid",   "tijd",      "tempo", "horaire", "juliandate", "hhmmss"};
  return std::ranges::find(words, word) != words.end();
}

/// Whose clock it is, or of what.
bool is_owner_of_time(const std::string& word) {
  constexpr std::array words{"gps", "sys",   "system", "session", "log",
                             "lcl", "local", "start",  "mid"};
  return std::ranges::find(words, word) != words.end();
}

bool is_called_time(const ColumnForm& column) {
  return std::ranges::any_of(split_words(column.logged), is_time_word);
}

struct TimeUnit {
  const char* word;
  const char* suffix;  // as sepcal's headers have it; empty: none has
};

constexpr std::array time_units{
    TimeUnit{"s", "s"},         TimeUnit{"sec", "s"},     TimeUnit{"secs", "s"},
    TimeUnit{"second", "s"},    TimeUnit{"seconds", "s"}, TimeUnit{"sekunden", "s"},
    TimeUnit{"secondes", "s"},  TimeUnit{"ms", "ms"},     TimeUnit{"msec", "ms"},
    TimeUnit{"millis", "ms"},   TimeUnit{"us", "us"},     TimeUnit{"usec", "us"},
    TimeUnit{"micros", "us"},   TimeUnit{"ns", "ns"},     TimeUnit{"min", "min"},
    TimeUnit{"minutes", "min"}, TimeUnit{"h", "h"},       TimeUnit{"hr", "h"},
    TimeUnit{"hours", "h"},     TimeUnit{"d", ""},        TimeUnit{"days", ""},
};

/// The unit of a column whose words are names of time and, last, its unit, "Elapsed Time (min)", or
/// that is called by its unit alone, "millis".
const TimeUnit* unit_of_time(const ColumnForm& column) {
  constexpr std::size_t shortest = 4;  // characters of such a name
  const std::vector<std::string> words = split_words(column.header);
  if (words.empty()) return nullptr;
  const auto unit = std::ranges::find(time_units, words.back(), &TimeUnit::word);
  if (unit == time_units.end()) return nullptr;
  const std::span names(words.data(), words.size() - 1);
  const auto is_of_time = [](const std::string& word) {
    return is_time_word(word) || is_owner_of_time(word);
  };
  const bool is_named = std::ranges::any_of(names, is_time_word);
  const bool is_alone = names.empty() && words.back().size() >= shortest;
  return is_alone || (is_named && std::ranges::all_of(names, is_of_time)) ? &*unit : nullptr;
}

/// The column's cells in the sampled rows that are not empty.
std::vector<std::string_view> cells_of(const SampledRows& rows, std::size_t cell) {
  std::vector<std::string_view> cells;
  for (const auto& row : rows) {
    if (cell < row.size() && !row[cell].empty()) cells.push_back(row[cell]);
  }
  return cells;
}

/// Whether nearly all of some cells are such: a log begins with cells that are not filled yet.
template <class Test>
bool are_mostly(const std::vector<std::string_view>& cells, const Test& test) {
  return !cells.empty() && 10 * std::ranges::count_if(cells, test) >= 9 * std::ssize(cells);
}

bool is_clock(std::string_view cell) { return parse_clock(cell).has_value(); }

std::optional<double> days_of(std::string_view cell, DateOrder order, bool with_time) {
  if (!with_time) return parse_date(cell, order);
  const auto stamp = parse_date_time(cell, order);
  return stamp ? std::optional(stamp->days) : std::nullopt;
}

/// The order in which dates are read; nothing where two orders tell other days, or none any.
std::optional<DateOrder> find_order(const std::vector<std::string_view>& cells, bool with_time) {
  const auto reads = [&](DateOrder order) {
    return are_mostly(
        cells, [&](std::string_view cell) { return days_of(cell, order, with_time).has_value(); });
  };
  const bool day_first = reads(DateOrder::day_first);
  const bool month_first = reads(DateOrder::month_first);
  if (!day_first && !month_first) return std::nullopt;
  const bool differ = std::ranges::any_of(cells, [&](std::string_view cell) {
    return days_of(cell, DateOrder::day_first, with_time) !=
           days_of(cell, DateOrder::month_first, with_time);
  });
  if (day_first && month_first && differ) return std::nullopt;
  return day_first ? DateOrder::day_first : DateOrder::month_first;
}

std::string date_text(double days) {
  const std::chrono::sys_days date{std::chrono::days(static_cast<int>(days))};
  const std::chrono::year_month_day ymd(date);
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(ymd.year()),
                     static_cast<unsigned>(ymd.month()), static_cast<unsigned>(ymd.day()));
}

/// Turns `column` into time.
void become_time(TableForm& form, ColumnForm& column, CellKind kind, const std::string& how) {
  for (ColumnForm& other : form.columns) {
    if (other.header == time_header) other.header += ".1";
  }
  form.notes.push_back(fmt::format("time is from '{}', {}", column.logged, how));
  column.kind = kind;
  column.header = time_header;
}

/// The first day of a column of dates.
double first_day_of(const std::vector<std::string_view>& cells, DateOrder order, bool with_time) {
  for (const std::string_view cell : cells) {
    if (with_time) {
      if (const auto stamp = parse_date_time(cell, order)) {
        return stamp->days + std::floor(stamp->seconds / day);
      }
    } else if (const auto date = parse_date(cell, order)) {
      return *date;
    }
  }
  return 0.0;
}

/// The date's column that belongs to a clock's: the nearest one.
const ColumnForm* find_date(const TableForm& form, const SampledRows& rows,
                            const ColumnForm& clock) {
  const ColumnForm* nearest = nullptr;
  const auto away = [&](const ColumnForm& column) {
    return column.cell < clock.cell ? clock.cell - column.cell : column.cell - clock.cell;
  };
  for (const ColumnForm& column : form.columns) {
    const auto cells = cells_of(rows, column.cell);
    const auto is_date = [](std::string_view cell) -> bool {
      return parse_date(cell, DateOrder::day_first) || parse_date(cell, DateOrder::month_first);
    };
    if (&column == &clock || !are_mostly(cells, is_date)) continue;
    if (are_mostly(cells, [](std::string_view cell) { return parse_number(cell).has_value(); }) &&
        !is_called_time(column)) {
      continue;
    }
    if (nearest == nullptr || away(column) < away(*nearest)) nearest = &column;
  }
  return nearest;
}

/// Whether several rows share a stamp.
bool repeats(const std::vector<std::string_view>& cells) {
  std::size_t stamps = 1;
  for (std::size_t i = 1; i < cells.size(); ++i) stamps += cells[i] != cells[i - 1] ? 1U : 0U;
  return cells.size() >= 2 * stamps;
}

/// "12:34" in a row of its own each: minutes and seconds, as a log of a row a minute is none.
bool are_minutes(const std::vector<std::string_view>& cells) {
  return !repeats(cells) && are_mostly(cells, [](std::string_view cell) {
    return std::ranges::count(cell, ':') == 1 && cell.find_first_of(".,") == std::string_view::npos;
  });
}

bool take_clock(TableForm& form, const SampledRows& rows, ColumnForm& column) {
  constexpr double minutes = 60.0;
  if (are_minutes(cells_of(rows, column.cell))) {
    column.scale = 1.0 / minutes;
    become_time(form, column, CellKind::clock, "minutes and seconds");
    return true;
  }
  const ColumnForm* date = find_date(form, rows, column);
  const auto dates = date == nullptr ? std::vector<std::string_view>() : cells_of(rows, date->cell);
  const auto order = find_order(dates, false);
  if (date == nullptr || !order) {
    column.is_of_day = true;
    become_time(form, column, CellKind::clock, "a time of day, in seconds since midnight");
    return true;
  }
  column.date_cell = date->cell;
  column.order = *order;
  column.first_day = first_day_of(dates, *order, false);
  become_time(form, column, CellKind::dated,
              fmt::format("with the date in '{}', in seconds since {} 00:00", date->logged,
                          date_text(column.first_day)));
  return true;
}

bool take_date_time(TableForm& form, ColumnForm& column,
                    const std::vector<std::string_view>& cells) {
  const auto order = find_order(cells, true);
  if (!order) {  // a time of day is left, and that is enough
    column.order = DateOrder::day_first;
    column.is_of_day = true;
    become_time(form, column, CellKind::date_time,
                "whose date can be read in two ways and is not needed: in seconds since midnight");
    return true;
  }
  column.order = *order;
  column.first_day = first_day_of(cells, *order, true);
  become_time(
      form, column, CellKind::date_time,
      fmt::format("a date and a time, in seconds since {} 00:00", date_text(column.first_day)));
  return true;
}

struct Epoch {
  double scale;  // s a count
  double first;  // count at 1970-01-01
  const char* unit;
};

/// Between the years 2000 and 2100 a count since an epoch is of one of these alone; `step` to the
/// next, usually.
std::optional<Epoch> find_epoch(double count, double step) {
  constexpr double year_2000 = 946'684'800.0;
  constexpr double year_2100 = 4'102'444'800.0;
  constexpr std::array epochs{Epoch{1.0, 0.0, "seconds"}, Epoch{1e-3, 0.0, "milliseconds"},
                              Epoch{1e-6, 0.0, "microseconds"}, Epoch{1e-9, 0.0, "nanoseconds"},
                              Epoch{1e-7, 116'444'736e9, "0.1 microseconds (Windows')"}};
  for (const Epoch& epoch : epochs) {
    const double seconds = (count - epoch.first) * epoch.scale;
    if (seconds >= year_2000 && seconds < year_2100) return epoch;
  }
  constexpr std::array calendars{Epoch{day, 25'569.0, "days (a spreadsheet's)"},
                                 Epoch{day, 719'529.0, "days (MATLAB's)"},
                                 Epoch{day, 2'440'587.5, "days (Julian)"}};
  constexpr double longest = 60.0;  // s from row to row; what steps on farther is no count of days
  for (const Epoch& epoch : calendars) {
    const double seconds = (count - epoch.first) * epoch.scale;
    if (step * day <= longest && seconds >= year_2000 && seconds < year_2100) return epoch;
  }
  return std::nullopt;
}

std::vector<double> numbers_of(const SampledRows& rows, const ColumnForm& column) {
  std::vector<double> numbers;
  for (const std::string_view cell : cells_of(rows, column.cell)) {
    if (const auto number = parse_number_as(cell, column.marks)) {
      numbers.push_back(*number);
    }
  }
  return numbers;
}

/// From one number to the next, on average; nothing where they don't rise.
std::optional<double> find_step(const std::vector<double>& numbers) {
  if (numbers.size() < 2 || !std::ranges::is_sorted(numbers)) return std::nullopt;
  const double step = (numbers.back() - numbers.front()) / static_cast<double>(numbers.size() - 1);
  return step > 0.0 ? std::optional(step) : std::nullopt;
}

/// Seconds that show themselves by their fractions: what steps on less than at 2 kHz is minutes or
/// more.
bool shows_seconds(const std::vector<double>& numbers) {
  constexpr double shortest = 5e-4;  // s between rows
  constexpr double longest = 1.5;
  const auto step = find_step(numbers);
  return step && *step >= shortest && *step <= longest &&
         std::ranges::any_of(numbers, [](double number) { return number != std::floor(number); });
}

bool take_seconds(TableForm& form, const SampledRows& rows, ColumnForm& column) {
  const std::vector<std::string> words = split_words(column.logged);
  if (std::ranges::find(words, "utc") != words.end()) return false;  // "100001.2" is 10:00:01.2
  if (!shows_seconds(numbers_of(rows, column))) return false;
  become_time(form, column, CellKind::number, "whose fractions are of seconds");
  return true;
}

/// Whether the header says how its numbers are written.
bool is_called_packed(const ColumnForm& column) {
  const std::vector<std::string> words = split_words(column.logged);
  return std::ranges::find(words, "hhmmss") != words.end();
}

/// "105630.5" is 10:56:30.5 where no seconds or minutes from 60 to 99 turn up, and a minute ends.
bool take_packed_clock(TableForm& form, const SampledRows& shown, ColumnForm& column) {
  constexpr std::size_t fewest = 12;
  const std::vector<double> numbers = numbers_of(shown, column);
  const auto is_clock = [](double number) {
    const double seconds = std::fmod(number, 100.0);
    const double minutes = std::fmod(std::floor(number / 100.0), 100.0);
    return number >= 0.0 && number < 240'000.0 && seconds < 60.0 && minutes < 60.0;
  };
  const auto ends_minute = [](double before, double after) {
    return std::floor(before / 100.0) != std::floor(after / 100.0);
  };
  const bool shows_itself = numbers.size() >= fewest && numbers.back() != numbers.front() &&
                            std::ranges::adjacent_find(numbers, ends_minute) != numbers.end();
  if (numbers.empty() || !std::ranges::all_of(numbers, is_clock) ||
      !(shows_itself || is_called_packed(column))) {
    return false;
  }
  column.is_of_day = true;
  become_time(form, column, CellKind::packed_clock,
              "a time of day as HHMMSS, in seconds since midnight");
  return true;
}

bool take_count(TableForm& form, const SampledRows& rows, ColumnForm& column) {
  const std::vector<double> numbers = numbers_of(rows, column);
  const auto step = find_step(numbers);
  if (!step) return false;
  const auto epoch = find_epoch(numbers.front(), *step);
  if (!epoch) return false;
  const double days = std::floor((numbers.front() - epoch->first) * epoch->scale / day);
  column.scale = epoch->scale;
  column.origin = epoch->first + days * day / epoch->scale;
  become_time(form, column, CellKind::counted,
              fmt::format("a count of {} since an epoch, in seconds since {} 00:00", epoch->unit,
                          date_text(days)));
  return true;
}

/// "1.714781E+09" row after row: a count since an epoch whose last digits were never written, so
/// that hardly any row differs from the one before. The first such cell; empty where it is none.
std::string_view find_lost_digits(const SampledRows& rows, const ColumnForm& column) {
  constexpr std::size_t fewest = 5;
  const auto cells = cells_of(rows, column.cell);
  const auto numbers = numbers_of(rows, column);
  const bool with_exponent = std::ranges::all_of(cells, [](std::string_view cell) {
    return cell.find_first_of("eE") != std::string_view::npos;
  });
  if (!with_exponent || cells.size() < fewest || numbers.size() != cells.size()) return {};
  return repeats(cells) && find_epoch(numbers.front(), 1.0) ? cells.front() : std::string_view();
}

}  // namespace

bool is_time_text(std::string_view cell) {
  constexpr auto order = DateOrder::day_first;
  constexpr auto american = DateOrder::month_first;
  if (cell.find_first_of(":-/.") == std::string_view::npos) return false;
  return parse_clock(cell) || parse_date_time(cell, order) || parse_date_time(cell, american) ||
         parse_date(cell, order) || parse_date(cell, american);
}

void find_time(const std::string& file, TableForm& form, const SampledRows& rows,
               const SampledRows& shown, const std::vector<std::string>& mapped) {
  const auto is_stamp = [](std::string_view cell) -> bool {
    return parse_date_time(cell, DateOrder::day_first) ||
           parse_date_time(cell, DateOrder::month_first);
  };
  const auto is_of_numbers = [&](const ColumnForm& column) {
    return are_mostly(cells_of(rows, column.cell), [&](std::string_view cell) {
      return parse_number_as(cell, column.marks).has_value();
    });
  };
  const auto is_mapped = [&](const ColumnForm& column) {
    return std::ranges::find(mapped, column.logged) != mapped.end() && is_of_numbers(column);
  };
  const auto is_exact = [&](const ColumnForm& column) {
    return unit_in(column.header, "time", UnitKind::time) != nullptr && is_of_numbers(column);
  };
  const auto exact = std::ranges::find_if(form.columns, is_exact);
  const auto refuse_lost_digits = [&](const ColumnForm& column) {
    const std::string_view cell = find_lost_digits(rows, column);
    if (cell.empty()) return;
    throw Error(
        fmt::format("{}: '{}' has lost the digits that tell its rows apart: row after row is '{}'; "
                    "have it written with all digits, as 1714781000.25",
                    file, column.logged, cell));
  };
  if (exact != form.columns.end()) {
    refuse_lost_digits(*exact);
    if (exact->header == time_header && !is_mapped(*exact)) take_packed_clock(form, shown, *exact);
    return;
  }
  for (ColumnForm& column : form.columns) {
    const TimeUnit* const unit = unit_of_time(column);
    if (unit == nullptr || is_mapped(column) || !is_of_numbers(column)) continue;
    if (*unit->suffix == '\0') return;  // nothing reads days without their epoch
    become_time(form, column, CellKind::number, fmt::format("in {}", unit->word));
    column.header = fmt::format("time_{}", unit->suffix);
    return;
  }
  // By how much they say: a date and a time, a clock, a count; of a kind those called time first.
  // Where several rows share a stamp, seconds with fractions are better.
  const auto take_any = [&](bool called, const auto& is_such, const auto& take) {
    for (ColumnForm& column : form.columns) {
      if (is_called_time(column) != called) continue;
      const auto cells = cells_of(rows, column.cell);
      if (!are_mostly(cells, is_such)) continue;
      for (ColumnForm& finer : form.columns) {
        if (!repeats(cells) || is_mapped(finer) || !is_called_time(finer)) continue;
        if (take_seconds(form, rows, finer)) return true;
      }
      return take(column, cells);
    }
    return false;
  };
  const auto with_date = [&](ColumnForm& column, const auto& cells) {
    return take_date_time(form, column, cells);
  };
  const auto of_day = [&](ColumnForm& column, const auto&) {
    return take_clock(form, rows, column);
  };
  for (const bool called : {true, false}) {
    if (take_any(called, is_stamp, with_date) || take_any(called, is_clock, of_day)) return;
  }
  for (ColumnForm& column : form.columns) {
    if (!is_called_time(column) || is_mapped(column)) continue;
    if (take_packed_clock(form, shown, column) || take_count(form, rows, column) ||
        take_seconds(form, rows, column)) {
      return;
    }
  }
  for (const ColumnForm& column : form.columns) {
    if (is_called_time(column)) refuse_lost_digits(column);
  }
}

double RisingClock::operator()(double seconds_of_day) {
  if (!std::isfinite(seconds_of_day)) return seconds_of_day;
  if (begun_ && seconds_of_day + days_ < last_ - day / 2.0) days_ += day;
  begun_ = true;
  last_ = seconds_of_day + days_;
  return last_;
}

}  // namespace sepcal::files
