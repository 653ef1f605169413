// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/row_blocks.hpp"

#include <algorithm>
#include <cstring>

#include "flight/files/row_cells.hpp"
#include "flight/files/table_form.hpp"
#include "flight/files/text_lines.hpp"
#include "flight/files/time_column.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal::files {
namespace {

/// Whole lines in about equal shares, each ending with a line's end but perhaps the last.
std::vector<std::string_view> split_at_lines(std::string_view text, std::size_t shares) {
  std::vector<std::string_view> parts;
  for (std::size_t i = 0; i < shares && !text.empty(); ++i) {
    const std::size_t end = text.find('\n', text.size() / (shares - i));
    const std::size_t length = end == std::string_view::npos ? text.size() : end + 1;
    parts.push_back(text.substr(0, length));
    text.remove_prefix(length);
  }
  if (!text.empty()) parts.push_back(text);
  return parts;
}

/// The line without its end; it is taken off `text`.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  while (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace

RowBlocks::RowBlocks(CsvReader& reader, std::size_t labels_at, base::ThreadPool& pool)
    : reader_(reader), labels_at_(labels_at), pool_(pool), is_plain_(reader.form_->is_plain()) {}

std::span<const RowPart> RowBlocks::next() {
  const std::string_view text = reader_.lines_->peek();
  const std::size_t parsed = text.empty() ? 0 : parse(text);
  if (parsed == 0) {
    read_by_rows();
    if (parts_.front().rows == 0) return {};
    return parts_;
  }
  const std::span<RowPart> parts(parts_.data(), parsed);
  std::size_t rows = 0;
  std::size_t bytes = 0;
  for (RowPart& part : parts) {
    part.lines = {{0, reader_.lines_->line() + rows + 1}};
    rows += part.rows;
    bytes += part.bytes;
    for (std::size_t i = 0; i < part.columns.size(); ++i) {
      if (!reader_.form_->columns[i].is_of_day) continue;
      for (double& time : part.columns[i]) time = (*reader_.clock_)(time);
    }
  }
  if (expected_rows_ == 0) {
    expected_rows_ = static_cast<std::size_t>(1.02 * static_cast<double>(rows) *
                                              static_cast<double>(reader_.lines_->bytes()) /
                                              static_cast<double>(bytes));
  }
  reader_.lines_->skip(bytes, rows);
  reader_.line_ = reader_.lines_->line();
  reader_.rows_ += rows;
  return parts;
}

/// One task reads on while the others parse. How many parts there are up to the first line that is
/// irregular, which none of them has.
std::size_t RowBlocks::parse(std::string_view text) {
  constexpr std::size_t shares = 4;  // a thread, so that none waits long for the last
  constexpr std::size_t least = std::size_t{1} << 14U;  // bytes that are worth a task
  const auto most = shares * static_cast<std::size_t>(pool_.threads());
  const auto texts = split_at_lines(text, std::clamp<std::size_t>(text.size() / least, 1, most));
  if (parts_.size() < texts.size()) parts_.resize(texts.size());
  std::vector<char> regular(texts.size(), 0);
  pool_.for_each(texts.size() + 1, [&](std::size_t task) {
    if (task == 0) {
      reader_.lines_->read_ahead();
    } else {
      regular[task - 1] = parse_part(texts[task - 1], parts_[task - 1]) ? 1 : 0;
    }
  });
  const auto broken = static_cast<std::size_t>(std::ranges::find(regular, 0) - regular.begin());
  return broken < texts.size() && parts_[broken].rows > 0 ? broken + 1 : broken;
}

/// The rows up to the first irregular line; false where there is one. The last line of a file that
/// ends without a line's end is such.
bool RowBlocks::parse_part(std::string_view text, RowPart& part) const {
  clear(part);
  RowCells row;
  const std::size_t whole = text.size();
  const TableForm& form = *reader_.form_;
  const ColumnForm& first = form.columns.front();
  while (!text.empty()) {
    const std::size_t before = text.size();
    if (text.find('\n') == std::string_view::npos) return false;
    const std::string_view line = take_line(text);
    const bool is_irregular =
        before - text.size() > longest_line || is_blank(line) || has_control(line) ||
        line.front() == '#' || line.front() == '%' || !row.cut(line, form.delimiter).empty() ||
        !is_whole(form, row.cells()) || row.cells()[first.cell] == first.logged;
    if (is_irregular) return false;
    take(row.cells(), part);
    part.bytes = whole - text.size();
  }
  return true;
}

/// What is irregular, or the end, is near: CsvReader knows it.
void RowBlocks::read_by_rows() {
  constexpr std::size_t most = 16;
  parts_.resize(1);
  RowPart& part = parts_.front();
  clear(part);
  std::size_t line = 0;
  while (part.rows < most && reader_.next()) {
    if (part.rows == 0 || reader_.line() != line + 1) {
      part.lines.push_back({part.rows, reader_.line()});
    }
    line = reader_.line();
    for (std::size_t i = 0; i < reader_.cells().size(); ++i) {
      put(i, reader_.number(i),
          reader_.wrong_length_.empty() ? reader_.cells()[i] : reader_.wrong_length_, part);
    }
    ++part.rows;
  }
}

void RowBlocks::take(std::span<const std::string_view> cells, RowPart& part) const {
  const TableForm& form = *reader_.form_;
  for (std::size_t i = 0; i < form.columns.size(); ++i) {
    const ColumnForm& column = form.columns[i];
    const std::string_view cell = cells[column.cell];
    put(i, is_plain_ ? parse_number(cell) : read_number(column, cells), cell, part);
  }
  ++part.rows;
}

void RowBlocks::put(std::size_t column, std::optional<double> number, std::string_view cell,
                    RowPart& part) const {
  if (column == labels_at_) {
    part.labels.push_back(to_utf8(cell));
    return;
  }
  if (!number && !part.first_text[column]) {
    part.first_text[column] = Flight::Cell{part.rows, to_utf8(cell)};
  }
  part.columns[column].push_back(number.value_or(not_a_number));
}

void RowBlocks::clear(RowPart& part) const {
  part.rows = 0;
  part.bytes = 0;
  part.lines.clear();
  part.labels.clear();
  part.first_text.assign(reader_.form_->columns.size(), std::nullopt);
  part.columns.resize(reader_.form_->columns.size());
  for (std::vector<double>& column : part.columns) column.clear();
}

}  // namespace sepcal::files
