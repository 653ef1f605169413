// SPDX-License-Identifier: BSD-3-Clause
// A calibration put to use: the log with the corrected readings beside the raw ones.
#pragma once

#include <string>
#include <vector>

#include "sepcal/flight/calibration.hpp"

namespace sepcal {

/// What was done, for people.
struct Applied {
  std::string output;  // the file that was written
  std::size_t rows = 0;
  std::size_t rows_left_empty = 0;   // nothing to calibrate: total below static pressure, dropped
  std::vector<std::string> headers;  // the columns added
  std::vector<std::string> notes;
};

/// The corrected readings of a flight: a value a row, NaN where there is none.
std::vector<CorrectedColumn> apply(const Calibration& calibration, const Flight& flight);

/// Copies every column and row of `file` to `output` as they stand and adds the corrected columns;
/// a row without a correction gets empty cells. `output` appears whole or not at all. Throws Error
/// for bad input, for columns of those names that are there already, and where `output` is `file`
/// or can't be written. `stream`: a file that may be longer than memory, by way of stream_csv();
/// effects, which look at whole columns, are then refused.
Applied apply_to_file(const Calibration& calibration, const std::string& file,
                      const std::string& output, const Progress& progress = {},
                      bool stream = false);

/// What was written, and the status of the calibration behind it; the JSON says the same.
std::string to_text(const Applied& applied, const Calibration& calibration,
                    Detail detail = Detail::brief);
std::string to_json(const Applied& applied, const Calibration& calibration);

}  // namespace sepcal
