// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "flight/files/text_lines.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

bool is_blank(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return is_blank(c); });
}

std::size_t skip_blanks(std::string_view text, std::size_t at) {
  while (at < text.size() && is_blank(text[at])) ++at;
  return at;
}

std::string_view drop_trailing_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

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
      lines_(std::make_unique<files::TextLines>(file_, std::move(progress))) {
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
  header_.assign(cells_.begin(), cells_.end());
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
  if (!text || is_blank(*text)) {
    if (text) refuse_rows_after_blank(lines_->line());
    if (line_ <= 1) throw Error(file_ + ": there is a header, but no row of data below it");
    cells_.clear();
    text_ = {};
    return false;
  }
  text_ = *text;
  line_ = lines_->line();
  split();
  if (cells_.size() != header_.size()) {
    fail(line_, fmt::format("{} cells, but the header has {} column{}; {}", cells_.size(),
                            header_.size(), header_.size() == 1 ? "" : "s",
                            cells_.size() < header_.size()
                                ? "complete the row or delete it"
                                : "quote a cell that holds a comma, and use a point in decimals"));
  }
  return true;
}

/// Cuts text_ into cells_: views without the blanks and quotes round them.
void CsvReader::split() {
  cells_.clear();
  unquoted_.clear();
  for (std::size_t at = 0;; ++at) {
    at = skip_blanks(text_, at);
    if (at < text_.size() && text_[at] == '"') {
      at = take_quoted(at);
    } else {
      const std::size_t comma = std::min(text_.find(',', at), text_.size());
      cells_.push_back(drop_trailing_blanks(text_.substr(at, comma - at)));
      at = comma;
    }
    if (at == text_.size()) return;
  }
}

/// Takes the cell whose opening quote is at `open`; returns where its comma or the line's end is.
std::size_t CsvReader::take_quoted(std::size_t open) {
  std::size_t close = open;
  bool doubled = false;
  for (;;) {
    close = text_.find('"', close + 1);
    if (close == std::string_view::npos) {
      fail(line_, fmt::format("the quote of cell {} is never closed; a quoted cell ends on its "
                              "line",
                              cells_.size() + 1));
    }
    if (close + 1 == text_.size() || text_[close + 1] != '"') break;
    doubled = true;
    ++close;
  }
  std::string_view cell = text_.substr(open + 1, close - open - 1);
  if (doubled) {
    unquoted_.reserve(text_.size());  // never grows beyond, so earlier views stay valid
    const std::size_t first = unquoted_.size();
    for (std::size_t i = 0; i < cell.size(); ++i) {
      unquoted_ += cell[i];
      if (cell[i] == '"') ++i;
    }
    cell = std::string_view(unquoted_).substr(first);
  }
  const std::size_t after = skip_blanks(text_, close + 1);
  if (after < text_.size() && text_[after] != ',') {
    fail(line_, fmt::format("text follows the closing quote of cell {}; double a quote that "
                            "belongs to the cell",
                            cells_.size() + 1));
  }
  cells_.push_back(cell);
  return after;
}

void CsvReader::refuse_rows_after_blank(std::size_t blank) {
  while (const auto text = lines_->next()) {
    if (!is_blank(*text)) fail(blank, "the line is blank, and rows follow; delete it");
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
