// SPDX-License-Identifier: BSD-3-Clause
// A streaming reader of comma-separated text: one header line, one row a line, memory of one chunk
// whatever the file's length. It knows text and cells; what they mean is Flight's business.
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
class TextLines;  // the file as lines
class RowCells;   // a line as cells
class RowBlocks;  // many rows at once
}  // namespace files

/// Told the fraction of a file that has been read, from 0 to 1, about once in two MiB. May be
/// empty.
using Progress = std::function<void(double fraction)>;

/// The finite decimal number that `text` is, the whole of it: "-1.5e3", "+2". Nothing for "",
/// "nan", "inf", "0x1p3", "1,5", "3 m" and for numbers too large or too small for a double.
std::optional<double> parse_number(std::string_view text);

/// Rows of cells, in the file's order. LF or CRLF line ends, a UTF-8 byte-order mark, blanks round
/// cells, a missing last line end and blank lines at the very end are taken; a cell may stand in
/// double quotes (a quote inside doubled), but no line end in them. Every error is one line,
/// "FILE line N: ...", N counted from 1, the header's.
class CsvReader {
 public:
  /// Opens the file and reads its header. Throws Error where the file isn't there, is a folder or
  /// can't be read, is empty or binary, is separated by semicolons or tabs, or has a column name
  /// that is empty or used twice.
  explicit CsvReader(std::string file, Progress progress = {});
  CsvReader(const CsvReader&) = delete;
  CsvReader& operator=(const CsvReader&) = delete;
  ~CsvReader();

  const std::string& file() const { return file_; }

  /// Column names without the blanks round them: unique and not empty.
  const std::vector<std::string>& header() const { return header_; }

  /// Goes to the next row; false at the end. Throws Error for a short or long row, a blank line
  /// between rows, an unclosed quote, bytes that no text has, a file without any row.
  bool next();

  /// The row's cells, as many as the header has. Valid until the next call of next().
  std::span<const std::string_view> cells() const;

  /// The row, or before the first next() the header, as it stands in the file, without its line
  /// end. Valid until the next call of next().
  std::string_view text() const { return text_; }

  /// Line number of the row, counted from 1, the header's.
  std::size_t line() const { return line_; }

  /// SHA-256 of the file's bytes, 64 lower-case hexadecimal digits. Throws Error before all were
  /// read.
  std::string sha256() const;

 private:
  friend class files::RowBlocks;

  void read_header();
  void split();
  void refuse_rows_after_blank(std::size_t blank);
  [[noreturn]] void fail(std::size_t line, const std::string& message) const;

  std::string file_;
  std::unique_ptr<files::TextLines> lines_;
  std::vector<std::string> header_;
  std::unique_ptr<files::RowCells> cells_;
  std::string_view text_;
  std::size_t line_ = 0;
};

}  // namespace sepcal
