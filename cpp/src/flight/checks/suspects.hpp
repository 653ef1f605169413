// SPDX-License-Identifier: BSD-3-Clause
// All columns of a log that a fit, an effect or a candidate may use, those with suspect rows: what
// the columns say of one another is taken into account.
#pragma once

#include <string>
#include <vector>

#include "flight/checks/log.hpp"
#include "flight/checks/suspect_rows.hpp"

namespace sepcal::checks {

struct SuspectColumn {
  std::string header;
  std::string unit;         // as headers spell it; empty where the header has none
  bool is_measured = true;  // by what a fit calibrates or holds it against; else it drives effects
  Manner manner = {};
  SuspectRows rows;
};

/// Jumps that the attitude or the body rates make too are motion, and so are those that two axes of
/// a magnetometer make at once: of these nothing is suspect. Throws nothing.
std::vector<SuspectColumn> find_suspects(const Log& log);

/// Whether a fit of the model measures it; else it is there for effects, or changes so slowly that
/// a value between its neighbours does as well.
bool is_measured(const Log& log, const LoggedColumn& column);

/// Conditions that leave these rows out, as --where takes them, all of which must hold: "not (100
/// <= time_s <= 101.8)". None where the log has no time to say it by.
std::vector<std::string> leave_out(const Log& log, const RowList& rows);

/// Those for all suspect rows of the column, a code by itself: "altitude_m != -9999".
std::vector<std::string> leave_out(const Log& log, const SuspectColumn& column);

}  // namespace sepcal::checks
