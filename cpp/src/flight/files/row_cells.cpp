// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/row_cells.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sepcal::files {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::size_t skip_blanks(std::string_view text, std::size_t at, char delimiter) {
  while (at < text.size() && is_blank(text[at]) && text[at] != delimiter) ++at;
  return at;
}

std::string_view drop_trailing_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace

bool is_blank(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return is_blank(c); });
}

std::string RowCells::cut(std::string_view text, char delimiter) {
  cells_.clear();
  unquoted_.clear();
  if (delimiter == ' ') text = drop_trailing_blanks(text.substr(skip_blanks(text, 0, '\0')));
  for (std::size_t at = 0;; ++at) {
    at = skip_blanks(text, at, delimiter == ' ' ? '\0' : delimiter);
    if (at < text.size() && text[at] == '"') {
      at = take_quoted(text, at, delimiter);
      if (at == std::string_view::npos) return fault_;
    } else {
      const std::size_t found =
          delimiter == ' ' ? text.find_first_of(" \t", at) : text.find(delimiter, at);
      const std::size_t end = std::min(found, text.size());
      cells_.push_back(drop_trailing_blanks(text.substr(at, end - at)));
      at = end;
    }
    if (at == text.size()) return "";
  }
}

std::size_t RowCells::take_quoted(std::string_view text, std::size_t open, char delimiter) {
  std::size_t close = open;
  bool doubled = false;
  for (;;) {
    close = text.find('"', close + 1);
    if (close == std::string_view::npos) {
      fault_ = fmt::format("the quote of cell {} is never closed; a quoted cell ends on its line",
                           cells_.size() + 1);
      return close;
    }
    if (close + 1 == text.size() || text[close + 1] != '"') break;
    doubled = true;
    ++close;
  }
  std::string_view cell = text.substr(open + 1, close - open - 1);
  if (doubled) {
    unquoted_.reserve(text.size());  // never grows beyond, so earlier views stay valid
    const std::size_t first = unquoted_.size();
    for (std::size_t i = 0; i < cell.size(); ++i) {
      unquoted_ += cell[i];
      if (cell[i] == '"') ++i;
    }
    cell = std::string_view(unquoted_).substr(first);
  }
  const std::size_t after = skip_blanks(text, close + 1, delimiter);
  const bool ends =
      after == text.size() || text[after] == delimiter || (delimiter == ' ' && after > close + 1);
  if (!ends) {
    fault_ = fmt::format(
        "text follows the closing quote of cell {}; double a quote that belongs to the cell",
        cells_.size() + 1);
    return std::string_view::npos;
  }
  cells_.push_back(cell);
  return delimiter == ' ' && after < text.size() ? after - 1 : after;
}

}  // namespace sepcal::files
