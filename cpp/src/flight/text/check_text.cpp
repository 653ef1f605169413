// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/page.hpp"
#include "base/short_number.hpp"
#include "flight/text/number_text.hpp"
#include "sepcal/flight/check.hpp"

namespace sepcal {

using base::Page;
using base::page;
using namespace text;  // this room's own

namespace {

/// "3355 rows in 74.9 s, 50 Hz, 9 segments"
Page size_line(const FlightCheck& check) {
  Page text = page("{}: {} rows of {}", check.model, check.rows, check.file);
  if (std::isfinite(check.duration)) {
    text += page(", {:.4g} s at {:.3g} Hz", check.duration, check.rate);
  }
  if (check.segments > 0) {
    text += page(", {} segment{}", check.segments, check.segments == 1 ? "" : "s");
  }
  return text + "\n";
}

Page use_line(const FlightCheck& check) {
  if (!check.refused.empty()) return page("a fit would refuse it: {}\n", check.refused);
  if (check.rows_used == check.rows) return "a fit would take all rows\n";
  return page("a fit would take {} of the rows\n", check.rows_used);
}

Page column_table(const FlightCheck& check) {
  std::size_t width = 6;
  for (const ColumnCheck& column : check.columns) width = std::max(width, column.header.size());
  Page text =
      page("{:<{}}  {:<8} {:>11} {:>11} {:>11} {:>9} {:>8} {:>8} {:>8}\n", "column", width,
           "read as", "least", "median", "largest", "step", "repeats", "new [Hz]", "missing");
  for (const ColumnCheck& column : check.columns) {
    const Page row =
        page("{:<{}}  {:<8} {:>11} {:>11} {:>11} {:>9} {:>6.0f} % {:>8} {:>8}", column.header,
             width, column.quantity.empty() ? "channel" : column.quantity,
             defined(column.least, "{:.5g}"), defined(column.median, "{:.5g}"),
             defined(column.largest, "{:.5g}"), defined(column.step, "{:.3g}"),
             100 * column.repeated, defined(column.rate, "{:.3g}"), column.missing);
    text += row + "\n";
  }
  return text;
}

std::string_view heading(Concern concern) {
  switch (concern) {
    case Concern::wrong:
      return "fix these first";
    case Concern::matters:
      return "matters";
    default:
      return "good to know";
  }
}

Page note_lines(const FlightCheck& check) {
  if (check.notes.empty()) return check.refused.empty() ? Page("nothing to note\n") : Page();
  Page text;
  const LogNote* before = nullptr;
  for (const LogNote& note : check.notes) {
    if (before == nullptr || before->concern != note.concern) {
      if (before != nullptr) text += "\n";
      text += page("{}:\n", heading(note.concern));
    }
    text += page("- {}\n", note.found);
    if (std::isfinite(note.first_s)) {
      text += note.rows == 1 ? page("    when: {} s\n", base::stamp(note.first_s))
                             : page("    when: {} rows, {} to {} s\n", note.rows,
                                    base::stamp(note.first_s), base::stamp(note.last_s));
    }
    text += page("    so: {}\n    do: {}\n", note.effect, note.advice);
    before = &note;
  }
  return text;
}

}  // namespace

std::string to_text(const FlightCheck& check) {
  return (size_line(check) + use_line(check) + "\n" + column_table(check) + "\n" +
          note_lines(check))
      .text();
}

}  // namespace sepcal
