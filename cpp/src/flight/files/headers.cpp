// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/headers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <numeric>
#include <optional>

namespace sepcal::files {
namespace {

/// Letters and digits alone, in lower case: "Roll [deg]" and "roll_deg" are one.
std::string strip(std::string_view header) {
  std::string letters;
  for (const char c : header) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) letters += static_cast<char>(std::tolower(byte));
  }
  return letters;
}

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

/// What a quantity is called elsewhere, without what parts the words.
struct OtherName {
  std::string_view quantity;
  std::string_view name;
};

constexpr std::array other_names{
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

bool is_called(std::string_view quantity, std::string_view name) {
  return name == quantity || std::ranges::any_of(other_names, [&](const OtherName& other) {
           return other.quantity == quantity && other.name == name;
         });
}

/// Whether letters spell the unit: "mps", or "m/s" without its stroke.
bool spells_unit(std::string_view letters, const Unit& unit) {
  if (letters == unit.suffix) return true;
  const std::size_t per = unit.suffix.rfind('p');
  const bool has_per =
      unit.kind == UnitKind::speed || unit.kind == UnitKind::rate || unit.kind == UnitKind::density;
  if (!has_per || per == std::string_view::npos) return false;
  return letters == std::string(unit.suffix).erase(per, 1);
}

/// The unit of a header that ends with the quantity by one of its names and a unit; else null.
const Unit* find_unit_after(std::string_view quantity, UnitKind kind, std::string_view header) {
  const std::vector<std::string> words = split_words(header);
  for (std::size_t first = 0; first < words.size(); ++first) {
    std::string name;
    for (std::size_t last = first; last + 1 < words.size(); ++last) {
      name += words[last];
      if (!is_called(quantity, name)) continue;
      std::string unit_letters;
      for (std::size_t k = last + 1; k < words.size(); ++k) unit_letters += words[k];
      for (const Unit& unit : known_units(kind)) {
        if (spells_unit(unit_letters, unit)) return &unit;
      }
    }
  }
  return nullptr;
}

/// Levenshtein's distance: the fewest letters inserted, deleted or replaced.
std::size_t count_slips(std::string_view from, std::string_view to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i] == to[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, diagonal + 1, replaced});
    }
  }
  return row.back();
}

/// A header of a log, and the accepted one that it nearly is.
struct NearMiss {
  std::string header;
  std::string accepted;
};

constexpr std::size_t longest_short_name = 3;  // p, vn, dpa, yaw: one letter makes another quantity
constexpr std::size_t longest_short_header = 8;  // of letters: one slip, beyond that two

std::optional<NearMiss> find_slip(std::string_view quantity,
                                  std::span<const std::string> accepted_ones,
                                  std::span<const std::string> candidates) {
  std::optional<NearMiss> nearest;
  std::size_t fewest = 0;
  for (const std::string& accepted : accepted_ones) {
    const std::string wanted = strip(accepted);
    const std::size_t allowed = wanted.size() > longest_short_header ? 2 : 1;
    for (const std::string& candidate : candidates) {
      const std::string letters = strip(candidate);
      if (quantity.size() <= longest_short_name && !letters.starts_with(quantity)) continue;
      const std::size_t slips = count_slips(letters, wanted);
      if (slips > allowed || (nearest && slips >= fewest)) continue;
      nearest = {candidate, accepted};
      fewest = slips;
    }
  }
  return nearest;
}

std::optional<NearMiss> find_other_name(std::string_view quantity, UnitKind kind,
                                        std::span<const std::string> candidates) {
  for (const std::string& candidate : candidates) {
    const Unit* unit = find_unit_after(quantity, kind, candidate);
    if (unit != nullptr) return {{candidate, fmt::format("{}_{}", quantity, unit->suffix)}};
  }
  return std::nullopt;
}

}  // namespace

std::vector<std::string> accepted_headers(std::string_view quantity, UnitKind kind) {
  std::vector<std::string> headers;
  for (const Unit& unit : known_units(kind)) {
    headers.push_back(fmt::format("{}_{}", quantity, unit.suffix));
  }
  return headers;
}

std::vector<double> read_quantity(const Flight& flight, std::string_view quantity, UnitKind kind) {
  for (const Flight::Column& column : flight.columns()) {
    const std::string_view header = column.header;
    const std::size_t split = header.rfind('_');
    if (split == std::string_view::npos || header.substr(0, split) != quantity) continue;
    const Unit* unit = find_unit(kind, header.substr(split + 1));
    if (unit == nullptr) continue;
    std::vector<double> values(column.values.size());
    std::ranges::transform(column.values, values.begin(),
                           [unit](double value) { return unit->convert(value); });
    return values;
  }
  return {};
}

std::string ask_for_near_miss(std::string_view quantity, UnitKind kind,
                              std::span<const std::string> others) {
  auto near = find_slip(quantity, accepted_headers(quantity, kind), others);
  if (!near) near = find_other_name(quantity, kind, others);
  if (!near) return "";
  return fmt::format("; did you mean '{}'? Rename it to {}", near->header, near->accepted);
}

std::string describe_missing(std::string_view quantity, UnitKind kind,
                             std::span<const std::string> others) {
  const std::vector<std::string> accepted = accepted_headers(quantity, kind);
  std::string text = fmt::format("column '{}' is missing", accepted.front());
  if (accepted.size() > 1) {
    text += fmt::format(" ({} would do as well)",
                        fmt::join(accepted.begin() + 1, accepted.end(), ", "));
  }
  return text + ask_for_near_miss(quantity, kind, others);
}

}  // namespace sepcal::files
