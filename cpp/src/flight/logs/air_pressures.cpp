// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/air_pressures.hpp"

#include <fmt/format.h>

#include "flight/files/headers.hpp"

namespace sepcal::logs {
namespace {

using files::LoggedQuantity;
using files::UnitKind;

std::vector<double> add_up(const LoggedQuantity& one, double sign, const LoggedQuantity& other) {
  std::vector<double> sum = one.values();
  for (std::size_t row = 0; row < sum.size(); ++row) sum[row] += sign * other.at(row);
  return sum;
}

}  // namespace

void complete_pressures(Flight& flight, std::vector<std::string>& notes) {
  if (flight.is_mapped()) return;
  const auto find = [&](const char* name, UnitKind kind) {
    return files::find_quantity(flight, name, kind);
  };
  const auto pt = find("pt", UnitKind::pressure);
  const auto ps = find("ps", UnitKind::pressure);
  const auto dp = find("dp", UnitKind::pressure);
  const bool is_five_hole = find("dpa", UnitKind::pressure).has_value();
  if (!ps) return;
  if (is_five_hole && dp && !pt) {
    notes.push_back(fmt::format("{}: pt is {} + {}", flight.name(), ps->column->logged_header(),
                                dp->column->logged_header()));
    flight.add("pt_pa", add_up(*ps, 1.0, *dp));
  } else if (!is_five_hole && pt && !dp && !find("airspeed", UnitKind::speed)) {
    notes.push_back(fmt::format("{}: dp is {} - {}", flight.name(), pt->column->logged_header(),
                                ps->column->logged_header()));
    flight.add("dp_pa", add_up(*pt, -1.0, *ps));
  }
}

}  // namespace sepcal::logs
