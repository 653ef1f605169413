// SPDX-License-Identifier: BSD-3-Clause
// A streaming reader of text tables, as loggers, spreadsheets and avionics write them: memory of
// one chunk whatever the file's length. It knows text and cells; what they mean is Flight's
// business.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal {

namespace files {
class TextLines;    // the file as lines
class RowCells;     // a line as cells
class RowBlocks;    // many rows at once
struct TableForm;   // how the table is written
class RisingClock;  // time of day across midnights
}  // namespace files

/// Told the fraction of a file that has been read, from 0 to 1, about once in two MiB. May be
/// empty.
using Progress = std::function<void(double fraction)>;

/// The finite decimal number that `text` is, the whole of it: "-1.5e3", "+2". Nothing for "",
/// "nan", "inf", "0x1p3", "1,5", "3 m" and for numbers too large or too small for a double.
std::optional<double> parse_number(std::string_view text);

/// How a file is written, where it may be read in two ways; empty: as it shows.
struct CsvForm {
  std::string delimiter = {};  // ",", ";", "|", "tab" or "space"
  std::string decimal = {};    // "." or ","

  /// Columns, as the file names them, that a choice renames: of none the unit of time is guessed.
  std::vector<std::string> mapped = {};
};

/// Rows of cells, in the file's order. It finds out how the table is written and says so in
/// notes(): commas, semicolons, tabs, strokes or blanks between columns; a decimal comma; groups of
/// thousands; UTF-8, UTF-16 or Windows-1252; LF, CRLF or CR; gzip or Zstandard; lines before the
/// header, comments, a row of units, no header; a delimiter more at each row's end; a last row that
/// is cut; NUL bytes at the end. A cell may stand in double quotes (a quote inside doubled), but no
/// line end in them. Every error is one line, "FILE line N: ...", N counted from 1, the file's
/// first.
class CsvReader {
 public:
  /// Opens the file and reads its header. Throws Error where the file isn't there, is a folder or
  /// can't be read, is empty or binary, and OptionError where `form` must say how to read it.
  explicit CsvReader(std::string file, Progress progress = {}, const CsvForm& form = {});
  CsvReader(const CsvReader&) = delete;
  CsvReader& operator=(const CsvReader&) = delete;
  ~CsvReader();

  const std::string& file() const { return file_; }

  /// Column names, unique and not empty: time_s where time is read from text or counts, with their
  /// unit where that is known, "vn (m/s)".
  const std::vector<std::string>& header() const { return header_; }

  /// The same as the file has them: "Lcl Time" of time_s.
  const std::vector<std::string>& logged() const { return logged_; }

  /// Goes to the next row; false at the end. Blank lines, comments and other lines without a number
  /// are passed. Throws Error for an unclosed quote, bytes that no text has, a file without any
  /// row.
  bool next();

  /// The row's cells, as many as the header has; all empty where the row has not as many. Valid
  /// until the next call of next().
  std::span<const std::string_view> cells() const;

  /// The number in column `column` of the row, in the header's unit: time in seconds where it is
  /// written as text. Nothing where the cell is no finite number.
  std::optional<double> number(std::size_t column) const;

  /// The row, or before the first next() the header, as a line of plain comma-separated text: as it
  /// stands in the file where it is such. Stamps of time are as the file has them, name and cells.
  /// Valid until the next call.
  std::string_view text();

  /// Line number of the row, counted from 1; before the first next() the header's.
  std::size_t line() const { return line_; }

  /// How the file was read where it left a choice, one line each. What is at the end is known
  /// there.
  const std::vector<std::string>& notes() const { return notes_; }

  /// SHA-256 of the file's bytes, 64 lower-case hexadecimal digits. Throws Error before all were
  /// read.
  std::string sha256() const;

 private:
  friend class files::RowBlocks;

  void read_header();
  bool take_row();
  bool repeats_header() const;
  bool breaks_off(bool whole) const;
  std::string write_row() const;
  void note_end();
  [[noreturn]] void fail(std::size_t line, const std::string& message) const;

  /// Lines that are no rows.
  struct Passed {
    std::size_t lines = 0;
    std::size_t first = 0;
    void count(std::size_t line);
  };

  std::string file_;
  std::unique_ptr<files::TextLines> lines_;
  std::unique_ptr<files::TableForm> form_;
  std::vector<std::string> header_;
  std::vector<std::string> logged_;
  std::unique_ptr<files::RowCells> row_;  // as the file has it
  std::vector<std::string_view> cells_;   // the columns'
  std::string wrong_length_;              // "5 cells, not 6"; empty: the row is whole
  std::unique_ptr<files::RisingClock> clock_;
  std::optional<double> time_of_row_;  // of the clock
  std::string_view line_text_;
  std::string plain_text_;
  std::size_t line_ = 0;
  std::size_t rows_ = 0;
  std::vector<std::string> notes_;
  Passed blank_;             // between rows
  std::size_t pending_ = 0;  // blank lines that may be the file's last
  Passed others_;            // comments, and text that is no row
  Passed headers_;           // that stand there once more
  bool last_is_cut_ = false;
};

}  // namespace sepcal
