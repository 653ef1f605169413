// SPDX-License-Identifier: BSD-3-Clause
// All columns of a log that a fit, an effect or a candidate may use, those with suspect rows: what
// the columns say of one another is taken into account.
#pragma once

#include <string>
#include <vector>

#include "flight/checks/log.hpp"
#include "flight/checks/suspect_rows.hpp"

namespace sepcal::checks {

/// What a fit does with a column, and so what can be done where it holds no reading.
enum class Role {
  measured,    // it is calibrated or held against: rows can be left out
  integrated,  // a state is carried along it, which a value between its neighbours harms less than
               // a row left out
  driver       // it drives effects at most, or changes so slowly that such a value does as well
};

struct SuspectColumn {
  std::string header;
  std::string unit;  // as headers spell it; empty where the header has none
  Role role = Role::measured;
  Manner manner = {};
  SuspectRows rows;
};

/// Jumps that the attitude or the body rates make too, of an aircraft any other sensor, are motion,
/// and so are those that two axes of a magnetometer make at once: of these nothing is suspect.
/// Throws nothing.
std::vector<SuspectColumn> find_suspects(const Log& log);

/// Of a column in a fit of the log's model.
Role role_of(const Log& log, const LoggedColumn& column);

/// Whether a fit of the model leaves out the rows of codes in what it measures by itself: equation
/// error does, which else refuses them.
inline bool leaves_codes_out(const Log& log) {
  return log.looks_at() == probes::LooksAt::coefficients;
}

/// Conditions that leave these rows out, as --where takes them, all of which must hold: "not (100
/// <= time_s <= 101.8)". None where the log has no time to say it by.
std::vector<std::string> leave_out(const Log& log, const RowList& rows);

/// Those for all suspect rows of the column, a code by itself: "altitude_m != -9999".
std::vector<std::string> leave_out(const Log& log, const SuspectColumn& column);

}  // namespace sepcal::checks
