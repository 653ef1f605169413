// SPDX-License-Identifier: BSD-3-Clause
// How a text table is written: what parts its columns and its decimals, which lines stand before
// its rows, what its columns are. Recognised from the lines that it begins with.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flight/files/number_text.hpp"
#include "flight/files/time_text.hpp"
#include "sepcal/flight/csv.hpp"

namespace sepcal::files {

/// How a column's cells give numbers.
enum class CellKind {
  number,
  clock,         // time of day
  packed_clock,  // as a number, HHMMSS
  date_time,     // in one cell
  dated,         // a date in one cell, the time of day in another
  counted        // time as a count since an epoch
};

struct ColumnForm {
  std::string header;    // unique and not empty
  std::string logged;    // the header as the file has it
  std::string written;   // where the table is written anew: that, with the unit of its own line
  std::size_t cell = 0;  // which of a row's
  NumberMarks marks = {};
  CellKind kind = CellKind::number;
  std::string suffix = {};    // a unit that stands in each cell behind the number
  std::size_t date_cell = 0;  // of `dated`
  DateOrder order = DateOrder::year_first;
  double first_day = 0.0;            // of dates; days since 1970-01-01
  bool is_of_day = false;            // time since midnight, which starts anew at the next
  double scale = 1.0;                // that a number is multiplied by; of `counted`: [s]
  double origin = 0.0;               // of `counted`: a count
  std::vector<double> missing = {};  // numbers that stand for none
};

struct TableForm {
  char delimiter = ',';         // ' ': runs of blanks
  bool is_odd = false;          // some have a minus or an exponent of another kind
  std::size_t cells = 0;        // of a row
  bool one_more = false;        // an empty cell may stand at a row's end
  std::size_t header_line = 0;  // counted from 1; 0: there is none
  std::size_t first_row = 1;    // its line
  NumberMarks last_marks = {};  // of the last cell
  int last_decimals = -1;       // of all rows seen; -1: they differ
  std::vector<ColumnForm> columns = {};
  std::vector<std::string> notes = {};

  /// Whether a row's cells are the columns, and numbers are written as C++ writes them.
  bool is_plain() const;
};

/// The form of the table whose text begins with these whole lines. `asked` decides where it may be
/// read in two ways; where it doesn't, throws OptionError. `file` opens messages.
TableForm recognise_table(const std::string& file, std::string_view text, const CsvForm& asked);

/// Column `column` of a row, in the header's unit. Nothing where it is no finite number.
std::optional<double> read_number(const ColumnForm& column,
                                  std::span<const std::string_view> cells);

/// Whether a row has as many cells as the table.
bool is_whole(const TableForm& form, std::span<const std::string_view> cells);

/// Whether a line is none of a table: a comment, or a rule between its head and its rows.
bool is_comment(std::string_view line);

}  // namespace sepcal::files
