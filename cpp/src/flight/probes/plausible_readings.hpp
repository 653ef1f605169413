// SPDX-License-Identifier: BSD-3-Clause
// Readings that no flight has: degrees headed as radians, hectopascals as pascals, gauss as
// microtesla. Each is worth a note and none is an error, for the log knows better than we do.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flight/files/units.hpp"

namespace sepcal::probes {

/// A quantity of a probe as the rows in use have it.
struct Reading {
  std::string header;  // as logged; where it was computed, the quantity's own name
  /// Where logged in the unit used inside, which may be a slip.
  std::optional<files::UnitKind> relabel;
  std::vector<double> values;  // in the unit used inside
  std::string logged = {};     // the log's own header, where it is another
};

/// Looks a quantity up by its base name ("yaw"); nothing where it is not in use.
using FindReading = std::function<std::optional<Reading>(std::string_view quantity)>;

/// What is wrong with some columns.
struct Implausible {
  std::vector<std::string> headers;
  std::string sentence;
};

/// One for each implausible quantity: angles beyond a turn (pitch: a quarter of one; no yaw that
/// counts turns in radians, as the course, the field or r shows), an absolute
/// temperature outside 150 to 400 K, a density outside 0.02 to 2 kg/m^3, a static pressure outside
/// 5 to 120 kPa, a dynamic pressure outside 1 Pa to 50 kPa, flow-angle pressures out of proportion
/// to it, a field outside 5 to 200 uT (read: 400 uT).
std::vector<Implausible> find_implausible(const FindReading& find,
                                          std::optional<double> field_strength = std::nullopt);

}  // namespace sepcal::probes
