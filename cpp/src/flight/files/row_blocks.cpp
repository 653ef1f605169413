// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/row_blocks.hpp"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "flight/files/row_cells.hpp"
#include "flight/files/text_lines.hpp"
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
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace

RowBlocks::RowBlocks(CsvReader& reader, std::size_t labels_at, base::ThreadPool& pool)
    : reader_(reader), labels_at_(labels_at), pool_(pool) {}

std::span<const RowPart> RowBlocks::next() {
  const std::string_view text = reader_.lines_->peek();
  if (text.empty() || !parse(text)) {
    read_by_rows();
  } else {
    const auto rows =
        std::accumulate(parts_.begin(), parts_.end(), std::size_t{0},
                        [](std::size_t sum, const RowPart& part) { return sum + part.rows; });
    if (expected_rows_ == 0) {
      expected_rows_ = static_cast<std::size_t>(1.02 * static_cast<double>(rows) *
                                                static_cast<double>(reader_.lines_->bytes()) /
                                                static_cast<double>(text.size()));
    }
    reader_.lines_->skip(text.size(), rows);
    reader_.line_ = reader_.lines_->line();
  }
  if (parts_.front().rows == 0) return {};
  return parts_;
}

/// One task reads on while the others parse; false where a line is irregular.
bool RowBlocks::parse(std::string_view text) {
  constexpr std::size_t shares = 4;  // a thread, so that none waits long for the last
  constexpr std::size_t least = std::size_t{1} << 14U;  // bytes that are worth a task
  const auto most = shares * static_cast<std::size_t>(pool_.threads());
  const auto texts = split_at_lines(text, std::clamp<std::size_t>(text.size() / least, 1, most));
  parts_.resize(texts.size());
  std::vector<char> regular(texts.size(), 0);
  pool_.for_each(texts.size() + 1, [&](std::size_t task) {
    if (task == 0) {
      reader_.lines_->read_ahead();
    } else {
      regular[task - 1] = parse_part(texts[task - 1], task - 1) ? 1 : 0;
    }
  });
  return std::ranges::find(regular, 0) == regular.end();
}

bool RowBlocks::parse_part(std::string_view text, std::size_t at) {
  RowPart& part = parts_[at];
  clear(part);
  RowCells row;
  while (!text.empty()) {
    const std::size_t before = text.size();
    const std::string_view line = take_line(text);
    if (before - text.size() > longest_line || is_blank(line) || !is_text(line)) return false;
    if (!row.cut(line).empty() || row.cells().size() != reader_.header().size()) return false;
    take(row.cells(), part);
  }
  return true;
}

/// The end, or what is wrong, is near: CsvReader says which.
void RowBlocks::read_by_rows() {
  constexpr std::size_t most = 1024;
  parts_.resize(1);
  RowPart& part = parts_.front();
  clear(part);
  while (part.rows < most && reader_.next()) take(reader_.cells(), part);
}

void RowBlocks::take(std::span<const std::string_view> cells, RowPart& part) const {
  part.columns.resize(cells.size());
  part.first_text.resize(cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i == labels_at_) {
      part.labels.emplace_back(cells[i]);
      continue;
    }
    const auto number = parse_number(cells[i]);
    if (!number && !part.first_text[i]) {
      part.first_text[i] = Flight::Cell{part.rows, std::string(cells[i])};
    }
    part.columns[i].push_back(number.value_or(not_a_number));
  }
  ++part.rows;
}

void RowBlocks::clear(RowPart& part) {
  part.rows = 0;
  part.labels.clear();
  part.first_text.clear();
  for (std::vector<double>& column : part.columns) column.clear();
}

}  // namespace sepcal::files
