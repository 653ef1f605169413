// SPDX-License-Identifier: BSD-3-Clause
// What a log is, column by column, and what that does to a calibration from it: looked at before
// anything is fitted, also where a fit would refuse the log.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/choices.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal {

/// One column of numbers. Numbers are in the header's unit, NaN where there is none.
struct ColumnCheck {
  std::string header;
  std::string quantity = {};  // that the probe reads it as, "airspeed"; empty: a channel
  std::size_t missing = 0;    // cells that are no finite number
  double least = not_a_number;
  double median = not_a_number;
  double largest = not_a_number;
  double step = not_a_number;  // that its values stand apart by, where they lie on steps
  double repeated = 0.0;       // share of rows that repeat the one before
  double rate = not_a_number;  // new values a second [Hz]
};

/// How much a note matters, worst first.
enum class Concern {
  wrong,    // a result is wrong, or there is none
  matters,  // estimates or their standard errors suffer
  slight,   // good to know
};

template <>
struct ChoiceNames<Concern> {
  static constexpr std::array<std::string_view, 3> names{"wrong", "matters", "slight"};
};

/// What a note predicts of a fit, which the fit may refute: a scale far off, a parameter at its
/// bound.
enum class Predicted { nothing, scale, bound };

/// Something about a log: what it is, what it does to the result, what to do.
struct LogNote {
  std::string kind;  // "held", "units", ...: results.md lists them
  Concern concern = Concern::slight;
  std::vector<std::string> columns = {};
  std::size_t rows = 0;           // concerned
  double first_s = not_a_number;  // time of the first and the last of these rows, as logged, in s
  double last_s = not_a_number;
  std::string found = {};
  std::string effect = {};
  std::string advice = {};
  Predicted predicts = Predicted::nothing;
};

struct FlightCheck {
  std::string model;
  std::string app;  // the command that fits it
  std::string file;
  std::string sha256;  // of the file's bytes; empty for arrays
  std::size_t rows = 0;
  std::size_t rows_used = 0;  // by a fit; 0 where it would refuse the log
  std::string refused = {};   // what fit would say then, and the way out; empty: it would take it
  double duration = not_a_number;  // [s], from the least to the largest stamp
  double rate = not_a_number;      // rows a second [Hz], by the median interval
  std::size_t segments = 0;        // that gaps and changes of maneuver make
  std::vector<ColumnCheck> columns = {};
  std::vector<LogNote> notes = {};  // worst first
};

/// Looks at all rows of the flight, for what this probe reads of it. Never throws for what the log
/// holds: columns that are missing, text, time that runs back are what it is there to tell.
/// `rows`: what a fit is to take. `spell`: how the reader types an option, by its name in code.
FlightCheck check(const Probe& probe, const Flight& flight, const LogChoice& log = {},
                  const std::function<std::string(const std::string& name)>& spell = {});

/// The notes that matter to a fit, a line each, worst first: at most six, then how many more there
/// are. Readings that look like another unit are Probe::prepare()'s to note.
std::vector<std::string> brief_notes(const FlightCheck& check);

/// The JSON object: model, inputs, refused, duration, rate, segments, columns [{column, quantity,
/// missing, least, median, largest, step, repeated, rate}], notes [{kind, concern, columns, rows,
/// first_s, last_s, found, effect, advice}].
std::string to_json(const FlightCheck& check);

/// The page that the apps print.
std::string to_text(const FlightCheck& check);

}  // namespace sepcal
