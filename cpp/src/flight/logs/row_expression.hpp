// SPDX-License-Identifier: BSD-3-Clause
// Conditions on a row of a log, such as "airspeed > 20 and not maneuver == 'taxi'":
//
//   condition  = both { ("or" | "||") both }
//   both       = one { ("and" | "&&") one }
//   one        = ("not" | "!") one | comparison
//   comparison = sum relation sum { relation sum }       10 < airspeed < 30
//              | "maneuver" ("==" | "!=") label | "(" condition ")"
//   relation   = "<" | "<=" | ">" | ">=" | "==" | "!="
//   sum        = product { ("+" | "-") product }
//   product    = factor { ("*" | "/") factor }
//   factor     = "-" factor | number | name | "abs" "(" sum ")" | "(" sum ")"
//   label      = 'text' | "text"
//
// A name is letters, digits, "_" and "." and begins with a letter or "_"; any other header stands
// in backquotes: `Mag X`. A comparison with a cell that is no number does not hold.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace sepcal::logs {

using RowNumber = std::function<double(std::size_t row)>;
using RowText = std::function<std::string_view(std::size_t row)>;
using RowTruth = std::function<bool(std::size_t row)>;

/// What names stand for.
struct RowNames {
  std::function<RowNumber(const std::string& name)> number;  // throws Error for a name unknown
  RowText maneuver;                                          // empty where there are no labels
};

/// The condition. Throws Error that says where the text is not one: "'airspeed >' ends where a
/// number, a name or '(' should come".
RowTruth parse_condition(std::string_view text, const RowNames& names);

}  // namespace sepcal::logs
