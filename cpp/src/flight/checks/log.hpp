// SPDX-License-Identifier: BSD-3-Clause
// A flight as the checks look at it: the probe's quantities in the units used inside, all rows,
// whatever they hold.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "flight/files/headers.hpp"
#include "flight/probes/quantities.hpp"
#include "flight/probes/sequence.hpp"
#include "sepcal/flight/check.hpp"

namespace sepcal::checks {

/// A quantity of the probe that was logged.
struct LoggedColumn {
  const probes::ProbeQuantity* quantity;
  files::LoggedQuantity logged;
  std::vector<double> values;  // in the unit used inside, NaN where the cell is none; no turn is
                               // jumped over by an angle
  probes::Sequence sequence;

  std::string_view name() const { return quantity->name; }

  /// By a fit; else a channel beside it.
  bool used() const { return !quantity->is_extra && quantity->taken != probes::Taken::never; }

  const std::string& header() const { return logged.column->header; }
  /// As the log has it, which an option may name.
  const std::string& log_header() const { return logged.column->logged_header(); }
  files::UnitKind kind() const { return logged.unit->kind; }
};

class Log {
 public:
  Log(const probes::ModelQuantities& model, const Flight& flight);

  probes::LooksAt looks_at() const { return looks_at_; }
  const Flight& flight() const { return flight_; }
  const std::vector<LoggedColumn>& columns() const { return columns_; }

  /// [s], a value a row; empty where it was not logged.
  std::span<const double> time() const { return time_; }

  /// Rows one after another in time, none of them alone: no clock fault, gap or change of maneuver
  /// within.
  const std::vector<Segment>& stretches() const { return stretches_; }

  /// Mean step of time within the stretches [s]; NaN where there are none.
  double interval() const;

  /// nullptr where it was not logged.
  const LoggedColumn* find(std::string_view quantity) const;

  /// All of them, or nothing.
  std::vector<const LoggedColumn*> find_all(std::initializer_list<std::string_view> names) const;

 private:
  probes::LooksAt looks_at_;
  const Flight& flight_;
  std::vector<double> time_;
  std::vector<Segment> stretches_;
  std::vector<LoggedColumn> columns_;
};

/// A note about some rows of the log; of none, about all of it.
LogNote note_on(const Log& log, std::string_view kind, Concern concern,
                std::vector<std::string> columns, std::span<const std::size_t> rows = {});

/// What was found, its effect and the way out, as a line of its own.
std::string in_one_line(const LogNote& note, const std::string& file);

/// "line 17": what the flight calls a row, without the flight's name.
std::string name_row(const Log& log, std::size_t row);

/// "vn_mps, ve_mps", of columns in a sentence.
std::string list_headers(const std::vector<std::string>& headers);

/// The value that half of these are below; NaN of none.
double median(std::vector<double> values);

}  // namespace sepcal::checks
