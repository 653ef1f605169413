// SPDX-License-Identifier: BSD-3-Clause
// What a fit takes of a log: its columns under other names, less some, and which rows. It travels
// in a calibration, so that later verbs take the same of the same flight, and rows of the same kind
// of another one.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sepcal/flight/csv.hpp"

namespace sepcal {

struct LogChoice {
  /// Headers as sepcal reads them, and the log's own: {"airspeed_kt", "TAS"}.
  std::map<std::string, std::string> map = {};

  /// Headers of columns that are as if they were not there.
  std::vector<std::string> ignore = {};

  /// Drop rows with a bad cell in a needed column instead of refusing them.
  bool drop_invalid = false;

  /// Slow columns, by quantity ("airspeed") or whole header ("airspeed_kt"): of the rows between
  /// their samples, held or interpolated, none is taken. Of several columns the slowest counts;
  /// where some are about as slow, a row in which any of these was sampled.
  std::vector<std::string> drop_repeats = {};

  /// Only rows in which this holds (row_expression.hpp has its grammar): "airspeed > 20"; empty:
  /// all.
  std::string where = {};

  /// Only rows within these times [s, as the log shows them]. Another flight has another clock:
  /// there they don't count.
  std::optional<double> from_time = std::nullopt;
  std::optional<double> to_time = std::nullopt;

  /// How the file is written, where it can be read in two ways: what parts its columns (",", ";",
  /// "tab", "space", "|") and its decimals ("." or ","); empty: as the file shows.
  std::string delimiter = {};
  std::string decimal = {};

  /// How quantities that are logged at other times than those of the measured one come to its rows:
  /// "smooth", "linear" or "held"; empty: they must stand in one row.
  std::string join = {};

  /// Take the white noise out of what the model reads as inputs, segment by segment. Outputs stay
  /// as they were logged.
  bool smooth_inputs = false;

  /// What of it says how to read the file.
  CsvForm form() const {
    CsvForm form{delimiter, decimal, {}};
    for (const auto& [header, logged] : map) form.mapped.push_back(logged);
    return form;
  }

  bool operator==(const LogChoice&) const = default;
};

}  // namespace sepcal
