// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/table_head.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <utility>

#include "flight/files/headers.hpp"
#include "flight/files/known_names.hpp"

namespace sepcal::files {
namespace {

// Beside what needs no list: "-" and "".
constexpr std::array unit_words{
    "%",      "cm",     "h",       "hour",    "hours", "hr",     "kmph",    "kn",         "mi",
    "miles",  "minute", "minutes", "msec",    "mt",    "nmi",    "oe",      "per",        "second",
    "a",      "amp",    "amps",    "bar",     "bool",  "c",      "celsius", "deg",        "degc",
    "degf",   "degm",   "degree",  "degrees", "dps",   "enum",   "f",       "fahrenheit", "feet",
    "flag",   "fpm",    "fps",     "ft",      "g",     "gals",   "gauss",   "gph",        "hpa",
    "hz",     "ident",  "in",      "inch",    "inhg",  "k",      "kelvin",  "kg",         "kgf",
    "km",     "kmh",    "knots",   "kpa",     "kph",   "kt",     "kts",     "lb",         "lbf",
    "lbs",    "m",      "mb",      "mbar",    "meter", "meters", "metre",   "metres",     "mg",
    "mgauss", "min",    "mm",      "mmhg",    "mph",   "mps",    "mps2",    "ms",         "mv",
    "n",      "ns",     "nt",      "ohm",     "pa",    "pct",    "percent", "psf",        "psi",
    "rad",    "radian", "radians", "rn",      "rpm",   "s",      "sec",     "seconds",    "t",
    "torr",   "ts",     "us",      "usec",    "ut",    "utc",    "v",       "volt",       "volts",
    "w",
};

using enum UnitKind;
constexpr std::array kinds_of_units{
    time,  angle,    rate,  angular_acceleration, length, speed, acceleration, mass,
    force, pressure, field, temperature,          density};

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

std::string_view without_brackets(std::string_view text) {
  while (text.size() >= 2 && (text.front() == '(' || text.front() == '[')) {
    text.remove_prefix(1);
    text.remove_suffix(1);
  }
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

bool says_nothing(std::string_view unit) {
  constexpr std::array words{"", "-", "--", "#", "1", "none", "n/a", "unitless", "null"};
  return std::ranges::find(words, in_lower_case(unit)) != words.end();
}

/// Whether each word of it, at blanks and signs of products and quotients, is one of a unit.
bool is_of_unit_words(std::string_view unit) {
  std::string word;
  bool any = false;
  const auto is_known = [&] {
    while (word.size() > 1 && std::isdigit(static_cast<unsigned char>(word.back())) != 0) {
      word.pop_back();
    }
    const bool is_number =
        word.size() == 1 && std::isdigit(static_cast<unsigned char>(word[0])) != 0;
    const bool known =
        word.empty() || is_number || std::ranges::find(unit_words, word) != unit_words.end();
    any = any || (!word.empty() && !is_number);
    word.clear();
    return known;
  };
  for (const char c : unit) {
    if (std::string_view(" /*.^-+()_").find(c) == std::string_view::npos) {
      word += c;
    } else if (!is_known()) {
      return false;
    }
  }
  return is_known() && any;
}

/// Whether the cell is what a quantity is called, by sepcal or by others.
bool is_quantity(const std::string& cell) {
  const std::vector<std::string> words = split_words(cell);
  return !words.empty() &&
         std::ranges::any_of(known_quantities(), [&](const KnownQuantity& quantity) {
           return unit_in(cell, quantity.name, quantity.kind) != nullptr ||
                  recognise(cell, quantity) || rank_name(quantity.name, words);
         });
}

/// Whether the cell is what a quantity is called, with its unit.
bool is_quantity_in_unit(const std::string& cell) {
  return std::ranges::any_of(known_quantities(), [&](const KnownQuantity& quantity) {
    return recognise(cell, quantity).has_value();
  });
}

/// How far a line's cells are names of `columns`: there, no units and different; those of
/// quantities count more, the most with a unit.
double score_names(const HeadLine& line, std::size_t columns) {
  std::set<std::string_view> names;
  double score = 0.0;
  for (const std::string& cell : line.cells) {
    if (says_nothing(cell) || !names.insert(cell).second) continue;
    if (is_quantity_in_unit(cell)) {
      score += 2.0;
    } else {
      score += is_quantity(cell) ? 1.5 : is_unit_like(cell) ? 0.0 : 1.0;
    }
  }
  return score / static_cast<double>(columns);
}

/// Which share of the cells that are not empty are units.
double score_units(const HeadLine& line) {
  const auto units = std::ranges::count_if(line.cells, is_unit_like);
  const auto empty = std::ranges::count_if(line.cells, &std::string::empty);
  const auto filled = static_cast<double>(line.cells.size()) - static_cast<double>(empty);
  return filled > 0.0 ? static_cast<double>(units) / filled : 0.0;
}

/// The unit that a name ends with: "kt" of "ias_kt" and of "IAS [kt]"; empty where it has none.
std::string_view unit_behind(std::string_view name) {
  if (name.ends_with(')') || name.ends_with(']')) {
    const std::size_t open = name.find_last_of("([");
    return open == std::string_view::npos ? std::string_view() : name.substr(open);
  }
  const std::size_t suffix = name.rfind('_');
  if (suffix == std::string_view::npos || !is_unit_like(name.substr(suffix + 1))) return {};
  return name.substr(suffix + 1);
}

}  // namespace

bool names_quantities(const std::vector<std::string>& cells) {
  return std::ranges::any_of(cells, is_quantity);
}

bool is_unit_like(std::string_view cell) {
  if (cell.empty()) return false;
  std::string unit = in_lower_case(without_brackets(cell));
  if (says_nothing(unit)) return true;
  if (unit.find("hh:mm") != std::string::npos || unit.starts_with("yyy")) return true;
  using Spelling = std::pair<std::string_view, std::string_view>;
  constexpr std::array spellings{
      Spelling{"\xC2\xB0", "deg"}, Spelling{"\xC2\xB5", "u"}, Spelling{"\xCE\xBC", "u"},
      Spelling{"\xC2\xB2", "2"},   Spelling{"\xC2\xB7", "*"}, Spelling{"\xE2\x81\xBB", "-"},
      Spelling{"\xC2\xB9", "1"},
  };
  for (const auto& [mark, word] : spellings) {
    for (auto at = unit.find(mark); at != std::string::npos; at = unit.find(mark)) {
      unit.replace(at, mark.size(), word);
    }
  }
  for (const std::string_view which : {" baro", " msl", " agl", " wgs", " gps", " true", " mag"}) {
    if (unit.ends_with(which)) unit.resize(unit.size() - which.size());
  }
  return is_of_unit_words(unit);
}

TableHead choose_head(const std::vector<HeadLine>& lines) {
  TableHead head;
  double best = 0.0;
  std::size_t columns = 1;
  for (const HeadLine& line : lines) columns = std::max(columns, line.cells.size());
  for (const HeadLine& line : lines) {
    const double score = score_names(line, columns);
    if (head.names != nullptr && score < best) continue;  // of equal ones the one next to the rows
    head.names = &line;
    best = score;
  }
  constexpr double least = 0.5;
  best = least;
  for (const HeadLine& line : lines) {
    const double score = score_units(line);
    if (&line == head.names || score < best || (head.units != nullptr && score == best)) continue;
    head.units = &line;
    best = score;
  }
  return head;
}

std::string with_unit(const std::string& name, std::string_view unit) {
  unit = without_brackets(unit);
  if (says_nothing(unit) || name.empty() || !unit_behind(name).empty()) return name;
  return fmt::format("{} ({})", name, unit);
}

bool contradicts_unit(std::string_view name, std::string_view unit) {
  const auto spelled = [](std::string_view text) {
    const std::vector<std::string> words = split_words(without_brackets(text));
    std::vector<std::pair<UnitKind, std::string_view>> units;
    for (const UnitKind kind : kinds_of_units) {
      for (const Unit& each : known_units(kind)) {
        if (spell_unit(words, each)) units.emplace_back(kind, each.suffix);
      }
    }
    return units;
  };
  const std::string_view own = unit_behind(name);
  if (own.size() == 1 && own != "m" && own != "s") return false;  // "wind_n" is no force
  const auto of_name = spelled(own);
  const auto of_line = spelled(unit);
  if (of_name.empty() || of_line.empty()) return false;
  return std::ranges::none_of(
      of_name, [&](const auto& each) { return std::ranges::find(of_line, each) != of_line.end(); });
}

}  // namespace sepcal::files
