// SPDX-License-Identifier: BSD-3-Clause
// A calibration: one probe fitted on one flight, with every option of the fit, so that later verbs
// need nothing but this and a flight. It is what BASE.json holds.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/fit.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal {

/// Options of a fit on a flight: the engine's, and what the files add.
struct CalibrationOptions {
  FitOptions fit;
  std::vector<std::string> free;  // parameters freed that the probe holds by default
  bool drop_invalid = false;
};

/// The flight that was fitted.
struct FittedFlight {
  std::string file;
  std::string sha256;  // of the file's bytes; empty for arrays
  std::size_t rows = 0;
  std::size_t rows_used = 0;  // by stage two
};

struct Calibration {
  std::shared_ptr<const Probe> probe;
  CalibrationOptions options;
  FittedFlight flight;
  Fit fit;
  std::vector<std::string> notes;  // one line each, for people; not part of the JSON
};

/// Fits `probe` to `flight`. Throws Error for bad input (prepare_five_hole() and its like), fewer
/// rows than parameters, and misuse (fit()).
Calibration calibrate(std::shared_ptr<const Probe> probe, const Flight& flight,
                      const CalibrationOptions& options = {});

inline constexpr int schema_version = 1;

/// The JSON of interface.md's "Results": one object, two-space indented, numbers that read back as
/// the same doubles, null where a number is undefined.
std::string to_json(const Calibration& calibration);

/// Reads what to_json() wrote; to_json() of the result is the same text. `source` opens the
/// messages. Throws Error for text that is not such an object, another schema version, or a model
/// of another app than `app` ("sepcal-pitot"; empty: any).
Calibration parse_calibration(std::string_view json, const std::string& source,
                              std::string_view app = {});

/// parse_calibration() of a file. Throws Error also where it can't be read.
Calibration read_calibration(const std::string& file, std::string_view app = {});

/// Writes to_json() to a file that appears whole or not at all.
void write_calibration(const Calibration& calibration, const std::string& file);

}  // namespace sepcal
