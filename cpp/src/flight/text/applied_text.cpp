// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "flight/text/status_text.hpp"
#include "sepcal/flight/apply.hpp"

namespace sepcal {

std::string to_text(const Applied& applied, const Calibration& calibration, Detail detail) {
  std::string line = fmt::format("wrote {}: {} rows, with {} added", applied.output, applied.rows,
                                 fmt::join(applied.headers, ", "));
  if (applied.rows_left_empty > 0) {
    line += fmt::format("; {} rows have no reading to calibrate and stay empty",
                        applied.rows_left_empty);
  }
  return line + "\n" + text::status_lines(calibration.fit, detail);
}

}  // namespace sepcal
