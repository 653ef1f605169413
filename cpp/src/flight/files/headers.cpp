// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/headers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "base/escaping.hpp"
#include "base/name_list.hpp"
#include "flight/files/known_names.hpp"

namespace sepcal::files {
namespace {

using Message = OptionError::Message;

/// A header of a log, the accepted one that it nearly is, and how near.
struct NearMiss {
  std::string header;
  std::string accepted;
  std::size_t slips = 0;
};

constexpr std::size_t foreign = 3;  // another name counts as more slips than are allowed

/// Whether the name is the quantity's but for one letter that lies beside the right key.
bool hits_the_next_key(std::string_view quantity, std::string_view name) {
  constexpr std::array<std::string_view, 3> keys{"qwertyuiop", "asdfghjkl", "zxcvbnm"};
  const auto differs = std::ranges::mismatch(quantity, name);
  if (quantity.size() != name.size() || differs.in1 == quantity.end()) return false;
  if (!std::equal(differs.in1 + 1, quantity.end(), differs.in2 + 1)) return false;
  return std::ranges::any_of(keys, [&](std::string_view row) {
    const std::size_t right = row.find(*differs.in1);
    const std::size_t hit = row.find(*differs.in2);
    return right != std::string_view::npos && hit != std::string_view::npos &&
           (right == hit + 1 || hit == right + 1);
  });
}

/// Slips of a letter between a quantity and words that should name it: none in a short name, where
/// a letter makes another quantity, but for the next key; two in a long one. Nothing where they are
/// too many.
std::optional<std::size_t> count_name_slips(std::string_view quantity, Words words) {
  constexpr std::size_t longest_short_name = 3;  // p, vn, dpa, yaw
  constexpr std::size_t longest_middling_name = 6;
  const std::string letters = join_words(words);
  const std::size_t slips = base::count_slips(letters, quantity);
  const std::size_t allowed = quantity.size() <= longest_short_name      ? 0
                              : quantity.size() <= longest_middling_name ? 1
                                                                         : 2;
  if (slips <= allowed) return slips;
  if (quantity.size() > 1 && hits_the_next_key(quantity, letters)) return slips;
  // Other names may stand behind a word or two of whose it is: "GPS vel N".
  for (std::size_t first = 0; first < words.size(); ++first) {
    const auto rank = rank_name(quantity, words.subspan(first), false);
    if (rank) return foreign + static_cast<std::size_t>(*rank);
  }
  return std::nullopt;
}

/// Of the ways to cut the header into a quantity and a unit, the nearest. A unit is never guessed:
/// it is spelled, or the header is none.
std::optional<NearMiss> compare_header(std::string_view quantity, UnitKind kind,
                                       const std::string& header) {
  std::optional<NearMiss> nearest;
  const auto offer = [&](std::optional<std::size_t> slips, const Unit& unit) {
    if (!slips || (nearest && nearest->slips <= *slips)) return;
    nearest = {header, fmt::format("{}_{}", quantity, unit.suffix), *slips};
  };
  const std::vector<std::string> words = split_words(header);
  for (const Unit& unit : known_units(kind)) {
    if (join_words(words) == std::string(quantity).append(unit.suffix)) offer(0, unit);
    for (std::size_t cut = 1; cut < words.size(); ++cut) {
      if (!spell_unit(Words(words).subspan(cut), unit)) continue;
      offer(count_name_slips(quantity, Words(words).first(cut)), unit);
    }
  }
  return nearest;
}

/// The nearest of them: several where none is nearer than the others.
std::vector<NearMiss> find_near_misses(std::string_view quantity, UnitKind kind,
                                       std::span<const std::string> candidates) {
  std::vector<NearMiss> nearest;
  for (const std::string& candidate : candidates) {
    const auto near = compare_header(quantity, kind, candidate);
    if (!near || (!nearest.empty() && nearest.front().slips < near->slips)) continue;
    if (!nearest.empty() && near->slips < nearest.front().slips) nearest.clear();
    nearest.push_back(*near);
  }
  return nearest;
}

/// A header of the quantity's own name with another unit or none.
const std::string* find_without_unit(std::string_view quantity,
                                     std::span<const std::string> candidates) {
  const auto found = std::ranges::find_if(candidates, [&](const std::string& candidate) {
    const std::vector<std::string> words = split_words(candidate);
    if (quantity.size() == 1 || words.empty()) return false;
    if (rank_name(quantity, words)) return true;
    if (words.front() != quantity) return false;
    if (words.size() > 1 && words[1] == "rate") return false;                 // another quantity
    return words.size() <= 2 || (words.size() == 3 && words[2].size() == 1);  // "ft/s"
  });
  return found == candidates.end() ? nullptr : &*found;
}

/// "; 'tow' is a time of week: ..." where time is missing and such a column says no unit.
Message ask_for_time_of_week(std::span<const std::string> others) {
  const auto found = std::ranges::find_if(others, [](const std::string& header) {
    return rank_name("gps_tow", split_words(header)).has_value();
  });
  if (found == others.end()) return {};
  return {fmt::format("; '{}' is a time of week without its unit: ", *found), Option{"map"},
          fmt::format(" {} reads it in s; known too: ms", map_pair("gps_tow_s", *found))};
}

}  // namespace

const Unit* unit_in(std::string_view header, std::string_view quantity, UnitKind kind,
                    const Unit* bare) {
  if (!header.starts_with(quantity)) return nullptr;
  const std::string_view rest = header.substr(quantity.size());
  if (rest.empty()) return bare;
  if (rest.front() != '_') return nullptr;
  const std::string_view suffix = rest.substr(1);
  return bare != nullptr && suffix == bare->suffix ? bare : find_unit(kind, suffix);
}

std::vector<std::string> accepted_headers(std::string_view quantity, UnitKind kind,
                                          const Unit* bare) {
  std::vector<std::string> headers;
  for (const Unit& unit : known_units(kind)) {
    headers.push_back(fmt::format("{}_{}", quantity, unit.suffix));
  }
  if (bare == nullptr) return headers;
  if (bare->kind == UnitKind::own && !bare->suffix.empty()) {
    headers.push_back(fmt::format("{}_{}", quantity, bare->suffix));
  }
  headers.emplace_back(quantity);
  return headers;
}

std::vector<double> LoggedQuantity::values() const {
  std::vector<double> values(column->values.size());
  std::ranges::transform(column->values, values.begin(),
                         [this](double value) { return unit->convert(value); });
  return values;
}

std::optional<LoggedQuantity> find_quantity(const Flight& flight, std::string_view quantity,
                                            UnitKind kind, const Unit* bare) {
  for (const Flight::Column& column : flight.columns()) {
    const Unit* unit = unit_in(column.header, quantity, kind, bare);
    if (unit != nullptr) return LoggedQuantity{&column, unit};
  }
  if (bare == nullptr) return std::nullopt;
  for (const Flight::Column& column : flight.columns()) {  // a name of somebody's own
    const Unit* unit = unit_in(column.logged, quantity, kind, bare);
    if (unit != nullptr) return LoggedQuantity{&column, unit};
  }
  return std::nullopt;
}

std::vector<double> read_quantity(const Flight& flight, std::string_view quantity, UnitKind kind) {
  const auto logged = find_quantity(flight, quantity, kind);
  return logged ? logged->values() : std::vector<double>();
}

bool turns_over_in_radians(std::span<const double> degrees) {
  constexpr double turn = 2.0 * std::numbers::pi;
  constexpr double least_jump = 0.8 * turn;
  constexpr double all_round = 0.95 * turn;
  double least = std::numeric_limits<double>::infinity();
  double largest = -least;
  bool jumps = false;
  double before = std::numeric_limits<double>::quiet_NaN();
  for (const double value : degrees) {
    if (!std::isfinite(value)) continue;
    least = std::min(least, value);
    largest = std::max(largest, value);
    jumps = jumps || std::abs(value - before) > least_jump;
    before = value;
  }
  const bool within =
      largest - least <= 1.001 * turn && largest <= 1.001 * turn && least >= -0.501 * turn;
  return within && (jumps || largest - least > all_round);
}

std::string map_pair(std::string_view accepted, std::string_view header) {
  return base::in_shell(fmt::format("{}={}", accepted, header));
}

std::optional<MappedColumn> find_near_column(std::string_view quantity, UnitKind kind,
                                             std::span<const std::string> others) {
  const std::vector<NearMiss> near = find_near_misses(quantity, kind, others);
  if (near.size() == 1) return MappedColumn{near[0].accepted, near[0].header, kind, true};
  const std::string* header = near.empty() ? find_without_unit(quantity, others) : nullptr;
  const auto units = known_units(kind);
  if (header == nullptr || units.empty() || header->find_first_of("([") != std::string::npos) {
    return std::nullopt;
  }
  return MappedColumn{fmt::format("{}_{}", quantity, units.front().suffix), *header, kind, false};
}

const Unit& likely_unit(const Flight& flight, std::string_view logged, UnitKind kind) {
  constexpr std::size_t looked_at = 2000;
  constexpr double usual_field = 60.0;  // [uT], of an axis at most, with hard iron
  const std::span<const Unit> units = known_units(kind);
  const auto found = std::ranges::find(flight.columns(), logged, &Flight::Column::logged_header);
  if (found == flight.columns().end()) return units.front();
  const std::span<const double> values(found->values.data(),
                                       std::min(found->values.size(), looked_at));
  double largest = 0.0;
  std::vector<double> steps;
  for (std::size_t row = 0; row < values.size(); ++row) {
    if (std::isfinite(values[row])) largest = std::max(largest, std::abs(values[row]));
    if (row > 0 && values[row] > values[row - 1]) steps.push_back(values[row] - values[row - 1]);
  }
  if (kind == UnitKind::angle) {
    constexpr double turn = 2.02 * std::numbers::pi;
    return largest > turn ? *find_unit(kind, "deg") : units.front();
  }
  if (kind == UnitKind::field && largest > 0.0) {
    return *std::ranges::min_element(units, {}, [&](const Unit& unit) {
      return std::abs(std::log(unit.convert(largest) / usual_field));
    });
  }
  if (kind == UnitKind::time && !steps.empty()) {
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::ranges::nth_element(steps, middle);
    for (const std::string_view suffix : {"s", "ms", "us", "ns"}) {
      constexpr double longest = 20.0;  // [s] between rows
      const Unit& unit = *find_unit(kind, suffix);
      if (unit.convert(*middle) <= longest) return unit;
    }
  }
  return units.front();
}

Message ask_for_columns(std::span<const MappedColumn> columns) {
  std::vector<std::string> pairs;
  std::vector<std::string> bare;
  std::vector<std::string_view> rest;  // units that the first of the bare may have too
  std::string_view taken;
  for (const MappedColumn& column : columns) {
    pairs.push_back(fmt::format("{}={}", column.accepted, column.header));
    if (column.says_unit) continue;
    if (bare.empty()) {
      taken = std::string_view(column.accepted).substr(column.accepted.rfind('_') + 1);
      for (const Unit& unit : known_units(column.kind)) {
        if (unit.suffix != taken) rest.push_back(unit.suffix);
      }
    }
    bare.push_back(fmt::format("'{}'", column.header));
  }
  const bool is_one = columns.size() == 1;
  std::string question =
      is_one ? fmt::format("; did you mean '{}'? ", columns[0].header) : "; did you mean these? ";
  std::string reads = is_one ? "reads it so" : "reads them so";
  if (!bare.empty()) {
    question = is_one
                   ? fmt::format("; {} says no unit that is known: ", bare[0])
                   : fmt::format("; no unit that is known is said by {}: ", fmt::join(bare, ", "));
    if (is_one) reads = fmt::format("reads it in {}", taken);
    if (!rest.empty()) reads += fmt::format("; known too: {}", fmt::join(rest, ", "));
  }
  return {std::move(question), Option{"map"},
          fmt::format(" {} {}", base::in_shell(fmt::format("{}", fmt::join(pairs, ","))), reads)};
}

Message ask_for_near_miss(std::string_view quantity, UnitKind kind,
                          std::span<const std::string> others) {
  if (const auto column = find_near_column(quantity, kind, others)) {
    return ask_for_columns({&*column, 1});
  }
  const std::vector<NearMiss> near = find_near_misses(quantity, kind, others);
  if (near.size() > 1) {
    return {fmt::format("; '{}' and '{}' could both be it: ", near[0].header, near[1].header),
            Option{"map"}, fmt::format(" {} decides", map_pair(near[0].accepted, near[0].header))};
  }
  if (const std::string* header = find_without_unit(quantity, others)) {
    const auto units = known_units(kind);
    if (units.empty()) return {};
    std::vector<std::string_view> all;
    for (const Unit& unit : units) all.push_back(unit.suffix);
    return {fmt::format("; '{}' is in a unit that is not known: convert it to one of {}", *header,
                        fmt::join(all, ", "))};
  }
  if (quantity == "time") return ask_for_time_of_week(others);
  return {};
}

Message around(std::string before, Message hint, std::string after) {
  hint.insert(hint.begin(), std::move(before));
  hint.emplace_back(std::move(after));
  return hint;
}

std::string say_missing(std::string_view quantity, UnitKind kind, const Unit* bare) {
  const std::vector<std::string> accepted = accepted_headers(quantity, kind, bare);
  std::string text = fmt::format("column '{}' is missing", accepted.front());
  if (accepted.size() > 1) {
    text += fmt::format(" ({} would do as well)",
                        fmt::join(accepted.begin() + 1, accepted.end(), ", "));
  }
  return text;
}

Message describe_missing(std::string_view quantity, UnitKind kind,
                         std::span<const std::string> others, const Unit* bare) {
  return around(say_missing(quantity, kind, bare), ask_for_near_miss(quantity, kind, others), "");
}

std::string header_of(const std::string& name, const std::string& unit) {
  if (unit.starts_with('1')) return name;
  std::string spelled = unit;
  for (std::size_t at = spelled.find('/'); at != std::string::npos; at = spelled.find('/')) {
    spelled.replace(at, 1, "p");
  }
  std::erase(spelled, '^');
  return name + "_" + spelled;
}

}  // namespace sepcal::files
