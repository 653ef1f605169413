// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/guards.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace sepcal::exporting {
namespace {

std::string name_of(std::size_t number) { return fmt::format("range_{}", number + 1); }

/// The range less its origin, wider by what the comparison's arguments round: none where a driver
/// is compared as it came.
std::vector<double> ends_of(const Guard& guard, const Dialect& dialect) {
  const double lower = guard.range.lower - guard.origin;
  const double upper = guard.range.upper - guard.origin;
  const double rounding = dialect.is_single() ? 1e-6 : guard.is_computed ? 1e-12 : 0.0;
  const double width = rounding * std::max(std::abs(lower), std::abs(upper));
  return {lower - width, upper + width};
}

}  // namespace

std::vector<Constant> guard_constants(const Correction& correction, const Dialect& dialect) {
  std::vector<Constant> constants;
  for (std::size_t i = 0; i < correction.guards.size(); ++i) {
    const Guard& guard = correction.guards[i];
    constants.push_back(
        {name_of(i), ends_of(guard, dialect), 0,
         fmt::format("{}{}: the least and the greatest that the fit saw", guard.channel,
                     guard.origin == 0.0 ? "" : fmt::format(" less {}", guard.origin))});
  }
  return constants;
}

std::string guard_statement(const Correction& correction, const Dialect& dialect) {
  std::vector<std::string> beyond;
  for (std::size_t i = 0; i < correction.guards.size(); ++i) {
    beyond.push_back(fmt::format("!({0} >= {1}[0] && {0} <= {1}[1])",
                                 correction.guards[i].expression, dialect.constant(name_of(i))));
  }
  if (beyond.empty()) return "";
  return fmt::format("  const int is_extrapolated = {};\n", fmt::join(beyond, " ||\n      "));
}

}  // namespace sepcal::exporting
