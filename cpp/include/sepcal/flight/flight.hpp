// SPDX-License-Identifier: BSD-3-Clause
// The table of one flight log, read from a CSV file or given as arrays: columns under their whole
// header, in the log's own units. Choosing columns, converting units and dropping rows come later
// (probe_columns.hpp), so what was logged stays as it was logged.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/flight/csv.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

namespace base {
class Spool;  // files that long columns lie in
}  // namespace base

class Flight {
 public:
  /// A cell that is no finite number.
  struct Cell {
    std::size_t row = 0;
    std::string text;
  };

  /// One of several flights that were joined, and its first row.
  struct Part {
    std::string name;
    std::size_t first = 0;
  };

  /// A row of a file that doesn't stand in the line behind the row before it; lines count from 1.
  struct Line {
    std::size_t row = 0;
    std::size_t line = 0;
  };

  struct Column {
    std::string header;                 // "roll_deg"
    std::span<const double> values;     // rows() of them, in the header's unit; NaN for text
    std::shared_ptr<const void> owner;  // keeps the values alive; may be empty
    std::optional<Cell> first_text;     // read from a file: the first cell that is no number
    std::string logged = {};            // the log's own header, where it is read under another

    /// As the log has it.
    const std::string& logged_header() const { return logged.empty() ? header : logged; }
  };

  /// An empty table. `name` opens its error messages; `sha256` is that of the file which the table
  /// was read from, empty for arrays.
  explicit Flight(std::string name = "flight", std::string sha256 = {})
      : name_(std::move(name)), sha256_(std::move(sha256)) {}

  /// Adds a column that the flight owns. Throws Error for an empty name, a name used twice,
  /// "maneuver" (which holds labels) and another length than the columns before.
  Flight& add(std::string header, std::vector<double> values);

  /// Adds a column without copying it; `owner` keeps the memory alive (or the caller does).
  Flight& view(std::string header, std::span<const double> values,
               std::shared_ptr<const void> owner = nullptr,
               std::optional<Cell> first_text = std::nullopt);

  /// Calls a column otherwise; its `logged` stays what the log called it. Throws Error as add()
  /// does for the new header, and where there is no such column.
  Flight& rename(std::string_view header, std::string to);

  /// Puts other values in a column's place, as many, which the flight owns. Throws Error as
  /// rename().
  Flight& replace(std::string_view header, std::vector<double> values);

  /// The same without a copy, as view().
  Flight& replace(std::string_view header, std::span<const double> values,
                  std::shared_ptr<const void> owner);

  /// Says what the log calls a column. Throws Error where there is none of that header.
  Flight& call_in_log(std::string_view header, std::string logged);

  /// Takes a column away. Throws Error as rename().
  Flight& drop(std::string_view header);

  /// The columns are mapped from files of `spool`, which may be longer than memory.
  Flight& map(std::shared_ptr<base::Spool> spool);

  /// Says that the rows are of several flights, one after the other: messages name rows by them.
  Flight& join(std::vector<Part> parts);

  /// Labels as stretches that cover the rows, instead of one a row, which maneuvers() then doesn't
  /// have.
  Flight& label_stretches(std::vector<Segment> stretches);

  /// Says in which lines of its file the rows stand, the first one first; none: rows have no lines.
  /// Without it a file's first row stands in line 2, below its header.
  Flight& number_lines(std::vector<Line> lines);

  /// Says that it was read from a text table of that form.
  Flight& read_as(CsvForm form);

  /// Adds what a reader decided about the file, one line for people; fits and checks repeat it.
  Flight& note(std::string text);

  /// Sets a label a row. Throws Error for a second set and for another length than the columns'.
  Flight& label(std::vector<std::string> maneuvers);

  /// The file as it was named, or the name given.
  const std::string& name() const { return name_; }

  /// Of the file's bytes, 64 hexadecimal digits; empty for arrays.
  const std::string& sha256() const { return sha256_; }

  std::size_t rows() const { return rows_; }
  const std::vector<Column>& columns() const { return columns_; }

  /// A label a row, or none at all where the log has no column "maneuver".
  std::span<const std::string> maneuvers() const {
    return maneuvers_ ? std::span<const std::string>(*maneuvers_) : std::span<const std::string>();
  }

  /// The labels as stretches; none where the log has no column "maneuver".
  std::vector<Segment> label_stretches() const;

  /// What its reader decided, one line each; none where the file left no choice.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Of the text table that it was read from; nothing of arrays and of files of another form.
  const std::optional<CsvForm>& form() const { return form_; }

  bool is_mapped() const { return spool_ != nullptr; }
  const std::shared_ptr<base::Spool>& spool() const { return spool_; }

  /// Lets the pages of rows [first, last) of mapped columns go; does nothing for others.
  void release(std::size_t first, std::size_t last) const;

  /// The column with that whole header, or else the one that the log has under it, or nullptr.
  const Column* find(std::string_view header) const;

  /// How a message names a row: "flight.csv line 17" (1 is the header), "flight row 15" (from 0).
  std::string locate(std::size_t row) const;

  /// How a message lists the columns: "the file has: time_s, vn_mps".
  std::string list_columns() const;

 private:
  bool from_file() const { return !sha256_.empty(); }
  void check_length(std::string_view header, std::size_t length);
  void check_header(const std::string& header) const;
  Column& column(std::string_view header);

  std::string name_;
  std::string sha256_;
  std::vector<Column> columns_;
  std::shared_ptr<const std::vector<std::string>> maneuvers_;  // copies share it
  std::vector<Segment> label_stretches_;
  std::vector<Part> parts_;
  std::vector<std::string> notes_;
  std::vector<Line> lines_{{0, 2}};
  std::optional<CsvForm> form_;
  std::shared_ptr<base::Spool> spool_;
  std::size_t rows_ = 0;
};

/// Reads a flight from a file of a form that the library doesn't know itself: an autopilot's log, a
/// Parquet file. `form` is what the file seems to be. Throws Error.
using ForeignReader = std::function<Flight(const std::string& file, const std::string& form)>;

/// Hands such files to `reader`; empty, as it begins: they are refused. Call it before files are
/// read.
void read_foreign_files_with(ForeignReader reader);

/// Reads a whole CSV file (csv.hpp says which). A column "maneuver" becomes the labels; every other
/// becomes numbers, with NaN and a memory of the first such cell where one is no finite number.
/// `threads` of them parse, the caller's included; 0: one a core. A file of another form goes to
/// the reader of read_foreign_files_with(). Throws Error as CsvReader does.
Flight read_csv(const std::string& file, const Progress& progress = {}, int threads = 0,
                const CsvForm& form = {});

/// The same of a file that may be longer than memory: block by block into files without a name in
/// `folder` (empty: $TMPDIR or /tmp; 8 bytes a cell), from where its columns are mapped. The file
/// may be a pipe. Throws Error as read_csv(), and where the folder's disc is full.
Flight stream_csv(const std::string& file, const std::string& folder = {},
                  const Progress& progress = {}, int threads = 0, const CsvForm& form = {});

}  // namespace sepcal
