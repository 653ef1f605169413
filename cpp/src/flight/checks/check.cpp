// SPDX-License-Identifier: BSD-3-Clause
#include "flight/checks/checked_subject.hpp"

#include <algorithm>
#include <cmath>

#include "flight/checks/clipping.hpp"
#include "flight/checks/clock.hpp"
#include "flight/checks/cross_checks.hpp"
#include "flight/checks/excitation.hpp"
#include "flight/checks/samples.hpp"
#include "flight/checks/suspect_notes.hpp"
#include "flight/checks/taken_rows.hpp"
#include "flight/files/headers.hpp"
#include "flight/probes/joined_quantities.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace checks;  // this room's own

namespace {

/// A column as it was logged, whatever the probe makes of it.
ColumnCheck describe_column(const Flight::Column& column, const Log& log) {
  ColumnCheck described{.header = column.header};
  std::vector<double> values;
  std::ranges::copy_if(column.values, std::back_inserter(values),
                       [](double value) { return std::isfinite(value); });
  described.missing = column.values.size() - values.size();
  if (!values.empty()) {
    const auto [least, largest] = std::ranges::minmax(values);
    described.least = least;
    described.largest = largest;
    described.median = checks::median(std::move(values));
  }
  const auto read = std::ranges::find(log.columns(), column.header, &LoggedColumn::header);
  const auto time = files::find_quantity(log.flight(), "time", files::UnitKind::time);
  const bool is_time = time && time->column->header == column.header;
  const probes::Sequence sequence = read != log.columns().end()
                                        ? read->sequence
                                        : probes::find_sequence(column.values, log.stretches());
  if (read != log.columns().end()) described.quantity = read->name();
  if (is_time) described.quantity = "time";
  described.step = sequence.step;
  described.repeated = sequence.repeated;
  described.rate = 1 / (log.interval() * sequence.rows_per_sample());
  return described;
}

/// All rows where the choice can't be followed, of which `refused` tells.
TakenRows take_what_can_be(const probes::ModelQuantities& quantities, const Flight& flight,
                           const LogChoice& choice) {
  try {
    return take_rows(quantities, flight, choice);
  } catch (const Error&) {
    return {flight};
  }
}

/// With what the flight shows of the instrument; nullptr where that is nothing, or can't be found,
/// which prepare() says too.
std::unique_ptr<const Probe> settled_by(const Probe& probe, const Flight& flight,
                                        const LogChoice& choice) {
  try {
    return probe.settle(flight, choice);
  } catch (const Error&) {
    return nullptr;
  }
}

/// What a fit would make of the flight.
void describe_use(const CheckedSubject& subject, const Flight& flight, const LogChoice& choice,
                  const std::function<std::string(const std::string& name)>& spell,
                  FlightCheck& check) {
  try {
    const ProbeRecord prepared = subject.prepare(flight, choice);
    check.rows_used = prepared.rows_used();
    check.segments = prepared.record.segments().size();
  } catch (const OptionError& error) {
    check.refused = spell ? error.spelled(spell) : error.what();
  } catch (const Error& error) {
    check.refused = error.what();
  }
}

}  // namespace

FlightCheck check(const Probe& given, const Flight& logged, const LogChoice& choice,
                  const std::function<std::string(const std::string& name)>& spell) {
  const std::unique_ptr<const Probe> settled = settled_by(given, logged, choice);
  const Probe& probe = settled ? *settled : given;
  const CheckedSubject subject{.model = std::string(probe.name()),
                               .app = std::string(probe.app()),
                               .quantities = probe,
                               .settings = probe.settings(),
                               .asks_for_turns = true,
                               .prepare = [&](const Flight& flight, const LogChoice& log) {
                                 return probe.prepare(flight, log);
                               }};
  return check_subject(subject, logged, choice, spell);
}

FlightCheck checks::check_subject(
    const CheckedSubject& subject, const Flight& logged, const LogChoice& choice,
    const std::function<std::string(const std::string& name)>& spell) {
  const ReadFlight read = probes::read_for(subject.quantities, logged, choice);
  const Flight& flight = read.flight;
  FlightCheck check{.model = subject.model,
                    .app = subject.app,
                    .file = flight.name(),
                    .sha256 = flight.sha256(),
                    .rows = flight.rows()};
  describe_use(subject, flight, choice, spell, check);
  const TakenRows taken = take_what_can_be(subject.quantities, flight, choice);
  const Log log(subject.quantities, taken.flight);
  check.rate = 1 / log.interval();
  if (std::isfinite(check.rate)) {
    std::vector<double> stamps;
    std::ranges::copy_if(log.time(), std::back_inserter(stamps),
                         [](double time) { return std::isfinite(time); });
    const auto [first, last] = std::ranges::minmax(stamps);
    check.duration = last - first;
  }
  for (const Flight::Column& column : taken.flight.columns()) {
    check.columns.push_back(describe_column(column, log));
    std::size_t& missing = check.columns.back().missing;
    missing -=
        std::min(missing, check.columns.back().quantity == "time" ? 0 : taken.left_out.size());
  }
  check_across(log, subject.settings, check.notes);
  if (subject.asks_for_turns) check_excitation(log, subject.settings, check.notes);
  check_samples(log, check.notes);
  check_clock(log, check.notes);
  check_clipping(log, check.notes);
  check_constants(log, check.notes);
  check_suspects(log, find_suspects(log), choice, check.notes);
  for (const std::string& note : read.notes) {
    check.notes.push_back({.kind = "read",
                           .concern = Concern::slight,
                           .found = note.substr(flight.name().size() + 2),
                           .effect = "every verb reads the log so",
                           .advice = "nothing, if that is right"});
  }
  std::ranges::stable_sort(check.notes, {}, &LogNote::concern);
  return check;
}

}  // namespace sepcal
