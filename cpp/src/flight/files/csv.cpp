// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "flight/files/row_cells.hpp"
#include "flight/files/text_lines.hpp"
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

CsvReader::CsvReader(std::string file, Progress progress)
    : file_(std::move(file)),
      lines_(std::make_unique<files::TextLines>(file_, std::move(progress))),
      cells_(std::make_unique<files::RowCells>()) {
  read_header();
}

CsvReader::~CsvReader() = default;

void CsvReader::read_header() {
  const auto text = lines_->next();
  if (!text) throw Error(file_ + ": the file is empty; its first line should name the columns");
  text_ = *text;
  line_ = 1;
  const auto commas = std::ranges::count(text_, ',');
  for (const auto& [separator, name] : {std::pair(';', "semicolons"), std::pair('\t', "tabs")}) {
    if (std::ranges::count(text_, separator) > commas) {
      fail(1, fmt::format("the columns are separated by {}; export the file with commas "
                          "between the columns and a point in decimals",
                          name));
    }
  }
  split();
  header_.assign(cells().begin(), cells().end());
  std::set<std::string_view> seen;
  for (std::size_t i = 0; i < header_.size(); ++i) {
    if (header_[i].empty()) {
      fail(1, fmt::format("column {} of {} has no name; name it or delete the column", i + 1,
                          header_.size()));
    }
    if (!seen.insert(header_[i]).second) {
      fail(1, fmt::format("column '{}' is there twice; rename or delete one", header_[i]));
    }
  }
}

bool CsvReader::next() {
  const auto text = lines_->next();
  if (!text || files::is_blank(*text)) {
    if (text) refuse_rows_after_blank(lines_->line());
    if (line_ <= 1) throw Error(file_ + ": there is a header, but no row of data below it");
    cells_->clear();
    text_ = {};
    return false;
  }
  text_ = *text;
  line_ = lines_->line();
  split();
  if (cells().size() != header_.size()) {
    fail(line_, fmt::format("{} cells, but the header has {} column{}; {}", cells().size(),
                            header_.size(), header_.size() == 1 ? "" : "s",
                            cells().size() < header_.size()
                                ? "complete the row or delete it"
                                : "quote a cell that holds a comma, and use a point in decimals"));
  }
  return true;
}

void CsvReader::split() {
  const std::string fault = cells_->cut(text_);
  if (!fault.empty()) fail(line_, fault);
}

std::span<const std::string_view> CsvReader::cells() const { return cells_->cells(); }

void CsvReader::refuse_rows_after_blank(std::size_t blank) {
  while (const auto text = lines_->next()) {
    if (!files::is_blank(*text)) fail(blank, "the line is blank, and rows follow; delete it");
  }
}

std::string CsvReader::sha256() const {
  if (!lines_->at_end()) throw Error(file_ + ": its SHA-256 is known once it was read to the end");
  return lines_->sha256();
}

void CsvReader::fail(std::size_t line, const std::string& message) const {
  throw Error(fmt::format("{} line {}: {}{}", file_, line, message,
                          header_.size() == 1 && !header_.front().empty()
                              ? " (its header has no comma; is this a CSV file?)"
                              : ""));
}

}  // namespace sepcal
