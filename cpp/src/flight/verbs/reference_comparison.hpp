// SPDX-License-Identifier: BSD-3-Clause
// What was calibrated against an independent sensor's columns of the same log.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"
#include "sepcal/record.hpp"

namespace sepcal::verbs {

/// A flight as read_as() gives it and as it came, row by row alike: where references are looked
/// for, in that order.
struct ReferenceLog {
  const Flight& read;
  const Flight& given;
};

/// The rows that are compared: those of the record's segments, each of them a row of the flight.
struct ComparedRows {
  const Record& record;
  const std::vector<std::size_t>& flight_rows;
};

/// One a name in `asked`, "TAS 2 [kt]" or "airspeed_kt=TAS 2". `calibrated`: what apply gives, a
/// value a row of the flight; of three columns of a field its strength, "field", too. Throws Error
/// as compare() does.
std::vector<ReferenceMisfit> compare_references(const std::vector<std::string>& asked,
                                                const std::vector<CorrectedColumn>& calibrated,
                                                const ReferenceLog& log, const ComparedRows& rows);

}  // namespace sepcal::verbs
