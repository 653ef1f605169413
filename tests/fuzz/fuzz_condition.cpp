// SPDX-License-Identifier: BSD-3-Clause
// Conditions on rows, as --where and where= hand them in.
#include <cmath>
#include <limits>

#include "flight/logs/row_expression.hpp"
#include "fuzzing.hpp"

namespace sepcal::fuzz {
namespace {

constexpr std::size_t rows = 4;

/// Any name is a column; one of its cells is empty.
logs::RowNames names() {
  const auto number = [](const std::string& name) -> logs::RowNumber {
    const auto size = static_cast<double>(name.size());
    return [size](std::size_t row) {
      return row == 0 ? std::numeric_limits<double>::quiet_NaN() : size - static_cast<double>(row);
    };
  };
  const auto label = [](std::size_t row) -> std::string_view { return row == 1 ? "turn" : "taxi"; };
  return {number, label};
}

void check_condition(const std::string& text) {
  const logs::RowTruth condition = logs::parse_condition(text, names());
  const logs::RowTruth bracketed = logs::parse_condition("(" + text + ")", names());
  const logs::RowTruth opposite = logs::parse_condition("not (" + text + ")", names());
  const logs::RowTruth sure = logs::parse_condition("(" + text + ") or 1 < 2", names());
  for (std::size_t row = 0; row < rows; ++row) {
    require(bracketed(row) == condition(row), "brackets change nothing");
    require(opposite(row) != condition(row), "'not' is the opposite");
    require(sure(row), "'or' holds where one side does");
  }
}

}  // namespace
}  // namespace sepcal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sepcal::fuzz;
  const std::string text(text_of(data, size));
  // Within limits of length and depth that the other forms would pass.
  if (!accepts([&] { static_cast<void>(sepcal::logs::parse_condition(text, names())); })) return 0;
  accepts([&] { check_condition(text); });
  return 0;
}
