// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/escaping.hpp"
#include "flight/files/csv_cells.hpp"
#include "flight/files/foreign_forms.hpp"
#include "flight/files/number_text.hpp"
#include "flight/files/row_cells.hpp"
#include "flight/files/table_form.hpp"
#include "flight/files/text_lines.hpp"
#include "flight/files/time_column.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

CsvReader::CsvReader(std::string file, Progress progress, const CsvForm& form)
    : file_(std::move(file)),
      lines_(std::make_unique<files::TextLines>(file_, std::move(progress))),
      row_(std::make_unique<files::RowCells>()),
      clock_(std::make_unique<files::RisingClock>()) {
  if (auto foreign = files::find_foreign_form(lines_->first_bytes())) {
    throw files::ForeignFile(file_, std::move(*foreign));
  }
  form_ = std::make_unique<files::TableForm>(files::recognise_table(file_, lines_->peek(), form));
  const bool is_empty = form_->columns.empty() && form_->cells > 0;
  if (is_empty) throw Error(file_ + ": no column has a name or a value; is this a CSV file?");
  for (const files::ColumnForm& column : form_->columns) {
    header_.push_back(column.header);
    logged_.push_back(column.logged);
  }
  read_header();
}

CsvReader::~CsvReader() = default;

void CsvReader::read_header() {
  if (!lines_->encoding().empty()) {
    notes_.push_back(fmt::format("the text is {}", lines_->encoding()));
  }
  notes_.insert(notes_.end(), form_->notes.begin(), form_->notes.end());
  bool is_foreign_text = false;
  bool is_windows = true;
  while (lines_->line() + 1 < form_->first_row || lines_->line() == 0) {
    if (form_->first_row == 1) break;
    const auto text = lines_->next();
    if (!text) throw Error(file_ + ": the file is empty; its first line should name the columns");
    is_foreign_text = is_foreign_text || !files::is_utf8(*text);
    is_windows = is_windows && files::may_be_windows(*text);
    if (form_->header_line != 0 && lines_->line() != form_->header_line) continue;
    line_ = lines_->line();
    const std::string fault = row_->cut(*text, form_->delimiter);
    if (!fault.empty()) fail(line_, fault);
    if (form_->header_line == 0) continue;
    const bool stays = form_->is_plain() && !files::is_comment(*text) &&
                       std::ranges::all_of(form_->columns, [](const files::ColumnForm& column) {
                         return column.header == column.logged;  // no line below gives its unit
                       });
    plain_text_ = stays ? std::string(*text) : "";
  }
  if (is_foreign_text && is_windows) {
    notes_.emplace_back("the text is not UTF-8: taken for Windows-1252");
  } else if (is_foreign_text) {
    notes_.push_back(
        fmt::format("the text is neither UTF-8 nor Windows-1252: convert it, as by iconv -f "
                    "SHIFT_JIS -t UTF-8 {0}, where it is Japanese, or -f GB18030 where Chinese",
                    base::file_in_shell(file_)));
  }
  if (plain_text_.empty()) {
    std::vector<std::string> written;
    for (const files::ColumnForm& column : form_->columns) written.push_back(column.written);
    plain_text_ = files::join_cells(written);
  }
  line_text_ = plain_text_;
}

void CsvReader::Passed::count(std::size_t line) {
  if (lines++ == 0) first = line;
}

bool CsvReader::next() {
  while (const auto text = lines_->next()) {
    line_ = lines_->line();
    if (files::is_blank(*text)) {
      ++pending_;
      continue;
    }
    line_text_ = *text;
    if (!take_row()) continue;
    for (; pending_ > 0; --pending_) blank_.count(line_ - pending_);
    ++rows_;
    return true;
  }
  if (rows_ == 0) throw Error(file_ + ": there is a header, but no row of data below it");
  cells_.clear();
  line_text_ = {};
  note_end();
  return false;
}

/// Makes the line the row; false where it is none.
bool CsvReader::take_row() {
  const std::string fault = row_->cut(line_text_, form_->delimiter);
  if (!fault.empty()) {
    if (!lines_->was_cut()) fail(line_, fault);
    last_is_cut_ = true;
    return false;
  }
  const auto cells = row_->cells();
  const bool whole = files::is_whole(*form_, cells);
  if (!whole || files::is_comment(line_text_)) {
    const bool is_text = std::ranges::none_of(
        cells, [](std::string_view cell) { return files::look_at_number(cell).is_number; });
    if (is_text) {
      others_.count(line_);
      return false;
    }
  }
  if (whole && repeats_header()) {
    headers_.count(line_);
    return false;
  }
  last_is_cut_ = breaks_off(whole);
  if (last_is_cut_) return false;
  wrong_length_ = whole ? "" : fmt::format("{} cells in a row of {}", cells.size(), form_->cells);
  cells_.clear();
  time_of_row_.reset();
  for (const files::ColumnForm& column : form_->columns) {
    cells_.push_back(whole ? cells[column.cell] : std::string_view());
    if (!column.is_of_day || !whole) continue;
    const auto seconds = files::read_number(column, cells);
    if (seconds) time_of_row_ = (*clock_)(*seconds);
  }
  return true;
}

/// Once more the names of the columns, as where files were put together.
bool CsvReader::repeats_header() const {
  return form_->header_line > 0 &&
         std::ranges::all_of(form_->columns, [&](const files::ColumnForm& column) {
           return files::to_utf8(row_->cells()[column.cell]) == column.logged;
         });
}

/// Whether the line ends with the file before its last digit.
bool CsvReader::breaks_off(bool whole) const {
  if (!lines_->was_cut()) return false;
  if (!whole) return true;
  return form_->last_decimals > 0 &&
         files::count_decimals(row_->cells()[form_->cells - 1], form_->last_marks.decimal) <
             form_->last_decimals;
}

std::span<const std::string_view> CsvReader::cells() const { return cells_; }

std::optional<double> CsvReader::number(std::size_t column) const {
  if (!wrong_length_.empty()) return std::nullopt;
  if (form_->columns[column].is_of_day) return time_of_row_;
  return files::read_number(form_->columns[column], row_->cells());
}

std::string_view CsvReader::text() {
  if (cells_.empty() || (form_->is_plain() && wrong_length_.empty())) return line_text_;
  std::vector<std::string> cells;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const bool is_stamp = form_->columns[i].kind != files::CellKind::number;
    const auto value = is_stamp ? std::nullopt : number(i);
    const bool is_text = form_->columns[i].missing.empty();  // else a flag that stands for none
    cells.push_back(value || !is_text ? "" : files::to_utf8(cells_[i]));
    if (value) files::append_number(cells.back(), *value);
  }
  plain_text_ = files::join_cells(cells);
  return plain_text_;
}

/// What is known of the file at its end.
void CsvReader::note_end() {
  const auto pass = [&](Passed& passed, const char* one, const char* many) {
    if (passed.lines == 1) {
      notes_.push_back(fmt::format("line {} is {} and is passed", passed.first, one));
    } else if (passed.lines > 1) {
      notes_.push_back(fmt::format("{} lines are {} and are passed, the first is line {}",
                                   passed.lines, many, passed.first));
    }
    passed = {};
  };
  pass(blank_, "blank", "blank");
  pass(others_, "no row", "no rows");
  pass(headers_, "the header once more", "the header once more");
  if (last_is_cut_)
    notes_.push_back(fmt::format("line {}, the last, breaks off and is left out", line_));
  if (lines_->nuls_at_end() > 0) {
    notes_.push_back(fmt::format("the file ends with {} NUL bytes", lines_->nuls_at_end()));
  }
  last_is_cut_ = false;
}

std::string CsvReader::sha256() const {
  if (lines_->sha256().empty()) {
    throw Error(file_ + ": its SHA-256 is known once it was read to the end");
  }
  return lines_->sha256();
}

void CsvReader::fail(std::size_t line, const std::string& message) const {
  throw Error(fmt::format("{} line {}: {}{}", file_, line, message,
                          header_.size() == 1 && !header_.front().empty()
                              ? " (its header has no comma; is this a CSV file?)"
                              : ""));
}

}  // namespace sepcal
