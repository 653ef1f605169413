// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/named_columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string_view>

#include "base/sentences.hpp"
#include "flight/files/headers.hpp"
#include "flight/files/known_names.hpp"

namespace sepcal::logs {
namespace {

using files::KnownQuantity;

/// A column that may be a quantity.
struct Claim {
  std::string header;
  std::string accepted;
  int rank = 0;
};

/// Whether the header is one of sepcal's, which nobody reads as anything else.
bool is_exact(std::string_view header) {
  return std::ranges::any_of(files::known_quantities(), [&](const KnownQuantity& quantity) {
    return files::unit_in(header, quantity.name, quantity.kind) != nullptr;
  });
}

/// The columns that may be the quantity, the nearest first.
std::vector<Claim> find_claims(const std::vector<std::string>& headers,
                               const KnownQuantity& quantity) {
  std::vector<Claim> claims;
  for (const std::string& header : headers) {
    if (const auto seen = files::recognise(header, quantity)) {
      claims.push_back(
          {header, fmt::format("{}_{}", quantity.name, seen->unit->suffix), seen->rank});
    }
  }
  std::ranges::stable_sort(claims, {}, &Claim::rank);
  return claims;
}

/// "airspeed_kt from 'TAS (kt)'", and what may be meant instead.
std::string describe(const std::vector<Claim>& claims) {
  const Claim& taken = claims.front();
  std::string text = fmt::format("{} from '{}'", taken.accepted, taken.header);
  const bool is_airspeed = taken.accepted.starts_with("airspeed_");
  if (claims.size() > 1) {
    text += fmt::format(" (not '{}')", claims[1].header);
  } else if (is_airspeed && files::is_indicated(taken.header)) {
    text += " (for the air at sea level: its scale grows with height)";
  }
  return text;
}

}  // namespace

void name_columns(Flight& flight, std::vector<std::string>& notes) {
  if (flight.find(files::flight_number) != nullptr) return;  // joined, each under these names
  std::vector<std::string> headers;
  for (const Flight::Column& column : flight.columns()) {
    // "temp_c" is a channel's name, by which effects know it.
    const bool is_channel = column.header.starts_with("temp_") &&
                            column.header.size() < std::string_view("temp_degc").size();
    if (!is_exact(column.header) && !is_channel) headers.push_back(column.header);
  }
  std::vector<std::string> taken;
  for (const KnownQuantity& quantity : files::known_quantities()) {
    if (files::find_quantity(flight, quantity.name, quantity.kind)) continue;
    const std::vector<Claim> claims = find_claims(headers, quantity);
    if (claims.empty()) continue;
    if (claims.size() > 1 && claims[0].rank == claims[1].rank) continue;  // nobody can tell
    flight.rename(claims.front().header, claims.front().accepted);
    std::erase(headers, claims.front().header);
    taken.push_back(describe(claims));
  }
  if (taken.empty()) return;
  notes.push_back(base::one_sentence(
      fmt::format("{}: columns are read as {}", flight.name(), fmt::join(taken, ", "))));
}

}  // namespace sepcal::logs
