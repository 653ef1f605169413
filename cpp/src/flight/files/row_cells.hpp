// SPDX-License-Identifier: BSD-3-Clause
// The cells of one line: cut at a delimiter, without the blanks and quotes round them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal::files {

/// Whether there is nothing but blanks and tabs.
bool is_blank(std::string_view text);

class RowCells {
 public:
  /// Cuts a line; at ' ', runs of blanks and tabs part cells. Returns what is wrong with it,
  /// nothing where all is well.
  std::string cut(std::string_view text, char delimiter = ',');

  /// Views of the line, or of this where doubled quotes became single ones. Valid until the next
  /// cut() and as long as the line.
  std::span<const std::string_view> cells() const { return cells_; }

  void clear() { cells_.clear(); }

 private:
  /// Takes the cell whose opening quote is at `open`; returns where its delimiter or the line's end
  /// is, or npos, with `fault_` set.
  std::size_t take_quoted(std::string_view text, std::size_t open, char delimiter);

  std::vector<std::string_view> cells_;
  std::string unquoted_;
  std::string fault_;
};

}  // namespace sepcal::files
