// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/headers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <numeric>
#include <optional>

#include "base/name_list.hpp"

namespace sepcal::files {
namespace {

using Words = std::span<const std::string>;

/// "GPS_VN (M/S)" as its words, in lower case: gps, vn, m, s.
std::vector<std::string> split_words(std::string_view header) {
  std::vector<std::string> words(1);
  for (const char c : header) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) {
      words.back() += static_cast<char>(std::tolower(byte));
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::string join(Words words) { return std::accumulate(words.begin(), words.end(), std::string()); }

/// What a quantity or a unit is called elsewhere, without what parts the words.
struct OtherName {
  std::string_view ours;
  std::string_view name;
};

constexpr std::array other_quantities{
    OtherName{"time", "t"},
    OtherName{"time", "timestamp"},
    OtherName{"roll", "phi"},
    OtherName{"pitch", "theta"},
    OtherName{"yaw", "psi"},
    OtherName{"yaw", "heading"},
    OtherName{"p", "rollrate"},
    OtherName{"q", "pitchrate"},
    OtherName{"r", "yawrate"},
    OtherName{"p", "gyrox"},
    OtherName{"q", "gyroy"},
    OtherName{"r", "gyroz"},
    OtherName{"vn", "veln"},
    OtherName{"vn", "vnorth"},
    OtherName{"ve", "vele"},
    OtherName{"ve", "veast"},
    OtherName{"vd", "veld"},
    OtherName{"vd", "vdown"},
    OtherName{"airspeed", "ias"},
    OtherName{"pt", "totalpressure"},
    OtherName{"ps", "staticpressure"},
    OtherName{"temp", "temperature"},
    OtherName{"temp", "oat"},
    OtherName{"mx", "magx"},
    OtherName{"my", "magy"},
    OtherName{"mz", "magz"},
};

constexpr std::array other_units{
    OtherName{"kt", "kts"},      OtherName{"kt", "knot"},      OtherName{"kt", "knots"},
    OtherName{"rad", "rads"},    OtherName{"deg", "degs"},     OtherName{"deg", "degree"},
    OtherName{"deg", "degrees"}, OtherName{"s", "sec"},        OtherName{"s", "seconds"},
    OtherName{"degc", "c"},      OtherName{"degc", "celsius"}, OtherName{"gauss", "g"},
    OtherName{"mgauss", "mg"},   OtherName{"hpa", "mbar"},
};

/// Whether `name` is what the table calls `ours`.
bool is_called(std::string_view ours, std::string_view name, std::span<const OtherName> table) {
  return name == ours || std::ranges::any_of(table, [&](const OtherName& other) {
           return other.ours == ours && other.name == name;
         });
}

/// Whether words spell the unit: "mps", "kts" in one, or "m", "s" for what is per something.
bool spell_unit(Words words, const Unit& unit) {
  if (words.empty()) return false;
  const std::string letters = join(words);
  if (words.size() == 1) return is_called(unit.suffix, letters, other_units);
  if (letters == unit.suffix) return true;  // "km/h"
  const std::size_t per = unit.suffix.rfind('p');
  const bool has_per = per != std::string_view::npos && unit.kind != UnitKind::pressure;
  return has_per && letters == std::string(unit.suffix).erase(per, 1);
}

/// A header of a log, the accepted one that it nearly is, and how near.
struct NearMiss {
  std::string header;
  std::string accepted;
  std::size_t slips = 0;
};

constexpr std::size_t foreign = 3;  // another name counts as more slips than are allowed

/// Slips of a letter between a quantity and words that should name it: none in a short name, where
/// a letter makes another quantity, two in a long one. Nothing where they are too many.
std::optional<std::size_t> count_name_slips(std::string_view quantity, Words words) {
  constexpr std::size_t longest_short_name = 3;  // p, vn, dpa, yaw
  constexpr std::size_t longest_middling_name = 6;
  const std::size_t slips = base::count_slips(join(words), quantity);
  const std::size_t allowed = quantity.size() <= longest_short_name      ? 0
                              : quantity.size() <= longest_middling_name ? 1
                                                                         : 2;
  if (slips <= allowed) return slips;
  // Other names may stand behind a word or two of whose it is: "GPS vel N".
  for (std::size_t first = 0; first < words.size(); ++first) {
    if (is_called(quantity, join(words.subspan(first)), other_quantities)) return foreign;
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
    if (join(words) == std::string(quantity).append(unit.suffix)) offer(0, unit);
    for (std::size_t cut = 1; cut < words.size(); ++cut) {
      if (!spell_unit(Words(words).subspan(cut), unit)) continue;
      offer(count_name_slips(quantity, Words(words).first(cut)), unit);
    }
  }
  return nearest;
}

std::optional<NearMiss> find_near_miss(std::string_view quantity, UnitKind kind,
                                       std::span<const std::string> candidates) {
  std::optional<NearMiss> nearest;
  for (const std::string& candidate : candidates) {
    const auto near = compare_header(quantity, kind, candidate);
    if (near && (!nearest || near->slips < nearest->slips)) nearest = near;
  }
  return nearest;
}

/// A header of the quantity's own name with another unit or none.
const std::string* find_without_unit(std::string_view quantity,
                                     std::span<const std::string> candidates) {
  const auto found = std::ranges::find_if(candidates, [&](const std::string& candidate) {
    const std::vector<std::string> words = split_words(candidate);
    if (quantity.size() == 1 || words.empty() || words.front() != quantity) return false;
    if (words.size() > 1 && words[1] == "rate") return false;                 // another quantity
    return words.size() <= 2 || (words.size() == 3 && words[2].size() == 1);  // "ft/s"
  });
  return found == candidates.end() ? nullptr : &*found;
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
  return std::nullopt;
}

std::vector<double> read_quantity(const Flight& flight, std::string_view quantity, UnitKind kind) {
  const auto logged = find_quantity(flight, quantity, kind);
  return logged ? logged->values() : std::vector<double>();
}

std::string ask_for_near_miss(std::string_view quantity, UnitKind kind,
                              std::span<const std::string> others) {
  if (const auto near = find_near_miss(quantity, kind, others)) {
    return fmt::format("; did you mean '{}'? Rename it to {}", near->header, near->accepted);
  }
  if (const std::string* header = find_without_unit(quantity, others)) {
    return fmt::format("; '{}' says no unit that is known: convert it or rename it", *header);
  }
  return "";
}

std::string describe_missing(std::string_view quantity, UnitKind kind,
                             std::span<const std::string> others, const Unit* bare) {
  const std::vector<std::string> accepted = accepted_headers(quantity, kind, bare);
  std::string text = fmt::format("column '{}' is missing", accepted.front());
  if (accepted.size() > 1) {
    text += fmt::format(" ({} would do as well)",
                        fmt::join(accepted.begin() + 1, accepted.end(), ", "));
  }
  return text + ask_for_near_miss(quantity, kind, others);
}

}  // namespace sepcal::files
