// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/headers.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
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

std::optional<NearMiss> find_near_miss(std::string_view quantity,
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
  const auto near = find_near_miss(quantity, accepted_headers(quantity, kind), others);
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
