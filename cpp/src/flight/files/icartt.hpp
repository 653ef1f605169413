// SPDX-License-Identifier: BSD-3-Clause
// The head of an ICARTT file of form 1001 (ICARTT File Format Standards V2.0, NASA ESDS-RFC-029):
// how many lines it has, what its columns are, and which numbers stand for none.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal::files {

struct IcarttColumn {
  std::string name;
  std::string unit;
  double scale = 1.0;                // that its numbers are multiplied by
  std::vector<double> missing = {};  // numbers that stand for none, before that
};

struct IcarttHead {
  std::size_t lines = 0;  // the last of them names the columns
  std::vector<IcarttColumn> columns;
};

/// Nothing where the lines are no such file's, or its head is not whole.
std::optional<IcarttHead> read_icartt(std::span<const std::string_view> lines);

}  // namespace sepcal::files
