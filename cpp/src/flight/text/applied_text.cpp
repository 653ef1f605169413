// SPDX-License-Identifier: BSD-3-Clause
#include "base/page.hpp"
#include "flight/text/status_text.hpp"
#include "sepcal/flight/apply.hpp"

namespace sepcal {

using base::joined;
using base::Page;
using base::page;

std::string to_text(const Applied& applied, const Calibration& calibration, Detail detail) {
  Page line = page("wrote {}: {} rows, with {} added", applied.output, applied.rows,
                   joined(applied.headers, ", "));
  if (applied.rows_left_empty > 0) {
    line += page("; {} rows have no reading to calibrate and stay empty", applied.rows_left_empty);
  }
  return (line + "\n" + text::status_lines(calibration.fit, detail)).text();
}

}  // namespace sepcal
