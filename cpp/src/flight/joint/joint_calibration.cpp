// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <ranges>
#include <utility>

#include "flight/joint/joint_probe.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal {

using namespace joint;  // this room's own

namespace {

/// What holds for an own parameter holds for each flight's.
CalibrationOptions of_each_flight(CalibrationOptions options, const JointSetup& setup) {
  for (const std::string& name : setup.own) {
    if (std::ranges::find(options.free, name) == options.free.end()) continue;
    throw OptionError(
        {Option{"free"}, fmt::format(" {0}: {0} is each flight's own, and free", name)});
  }
  spread_own(options.fit.fix, setup);
  spread_own(options.fit.bounds, setup);
  spread_own(options.fit.start, setup);
  spread_own(options.fit.prior, setup);
  return options;
}

/// Whether something is said of flights' own parameters that a test without it would not know.
bool is_said_of_own(const CalibrationOptions& options, const JointSetup& setup) {
  const auto of_one = [&](const auto& entry) { return is_of_one_flight(setup, entry.first); };
  return std::ranges::any_of(options.fit.bounds, of_one) ||
         std::ranges::any_of(options.fit.prior, of_one) ||
         std::ranges::any_of(options.fit.fix, of_one);
}

template <class Value>
void drop_own(std::map<std::string, Value>& by_name, const JointSetup& setup) {
  std::erase_if(by_name, [&](const auto& entry) {
    return is_own(setup, entry.first) || is_of_one_flight(setup, entry.first);
  });
}

/// The options without what is said of flights' own parameters.
CalibrationOptions without_own(CalibrationOptions options, const JointSetup& setup) {
  drop_own(options.fit.bounds, setup);
  drop_own(options.fit.start, setup);
  drop_own(options.fit.prior, setup);
  drop_own(options.fit.fix, setup);
  return options;
}

/// A record's segments of one flight.
Record rows_of_flight(const Record& record, double number) {
  const auto numbers = record.column(flight_number);
  std::vector<Segment> segments;
  for (const Segment& segment : record.segments()) {
    if (numbers[segment.first] == number) segments.push_back(segment);
  }
  Record part = record;
  part.cut(std::move(segments));
  return part;
}

FlightDeparture describe_departure(const FlightFit& flight) {
  const Departure& departure = flight.departure;
  FlightDeparture described{.flight = flight.name, .p = departure.p_holm};
  double most = 0.0;
  for (std::size_t k = 0; k < departure.names.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    const double size = std::abs(departure.difference[at] / departure.standard_error[at]);
    if (!(size > most)) continue;
    most = size;
    described.parameter = departure.names[k];
    described.difference = departure.difference[at];
    described.standard_error = departure.standard_error[at];
  }
  return described;
}

/// Whether a flight is the one that was fitted, or all of them, joined: by its bytes, else its
/// name.
template <class Fitted>
bool is_the_same(const Fitted& fitted, const Flight& flight) {
  const bool by_name = fitted.sha256.empty() || flight.sha256().empty();
  return by_name ? fitted.file == flight.name() : fitted.sha256 == flight.sha256();
}

const JoinedFlight* find_flight(const JointSetup& setup, const Flight& flight) {
  const auto found = std::ranges::find_if(
      setup.flights, [&](const JoinedFlight& one) { return is_the_same(one, flight); });
  return found == setup.flights.end() ? nullptr : &*found;
}

/// What is missing may be there in all flights but one.
Calibration calibrate_or_say_why(const std::shared_ptr<const Probe>& probe, const Flight& joined,
                                 const CalibrationOptions& options,
                                 const std::vector<std::string>& notes) {
  try {
    return calibrate(probe, joined, options);
  } catch (const Error& error) {
    if (notes.empty()) throw;
    throw_within("", error, "; " + notes.front());
  }
}

}  // namespace

/// By fit_many.hpp, with the effects that the calibration has.
void JointProbe::judge_flights(Calibration& calibration, const Flight& joined) const {
  calibration.departures.clear();
  const JointSetup& setup = setup_;
  CalibrationOptions options = without_own(calibration.options, setup);
  if (options.fit.loss != Loss::squares || one_->with_noise(1.0) || !initial_states().empty() ||
      is_said_of_own(calibration.options, setup)) {
    calibration.notes.emplace_back(
        "flights are not tested for their departure from each other where a loss forgives "
        "outliers, where the model has a state or depends on its own noise, or where bounds, a "
        "prior or a value are given of what is each flight's own");
    return;
  }
  const verbs::PreparedFlight prepared = verbs::prepare(calibration, joined);
  const EffectiveFlight flight =
      with_effects(*one_, prepared.flight, prepared.readings, options.effects, options.own_effects,
                   options.fit.bounds);
  const Record record = flight.prepared.record.select(options.fit.stage_two_segments);
  ManyOptions many{.own = setup.own, .fit = one_->complete(options.fit, record)};
  many.fit.stage_one_segments.clear();
  many.fit.stage_two_segments.clear();
  std::vector<std::pair<std::string, Record>> flights;
  for (std::size_t k = 0; k < setup.flights.size(); ++k) {
    flights.emplace_back(setup.flights[k].label, rows_of_flight(record, static_cast<double>(k)));
  }
  try {
    for (const FlightFit& one : fit_many(*flight.model, std::move(flights), many).flights) {
      calibration.departures.push_back(describe_departure(one));
    }
  } catch (const Error& error) {
    calibration.notes.push_back(fmt::format(
        "flights are not tested for their departure from each other: {}", error.what()));
  }
}

Calibration calibrate_jointly(const std::shared_ptr<const Probe>& probe,
                              const std::vector<Flight>& flights,
                              const std::vector<std::string>& own,
                              const CalibrationOptions& options) {
  std::vector<std::string> notes;
  const Flight joined = join_flights(flights, options.log, notes);
  const std::shared_ptr<const Probe> joint =
      joint_probe(probe, {.own = own, .flights = describe_flights(flights)});
  Calibration calibration =
      calibrate_or_say_why(joint, joined, of_each_flight(options, *joint_setup(*joint)), notes);
  std::ranges::move(notes, std::back_inserter(calibration.notes));
  joint->judge_flights(calibration, joined);
  return calibration;
}

Calibration for_flight(const Calibration& calibration, const Flight& flight) {
  const JointProbe* const probe = as_joint(*calibration.probe);
  if (probe == nullptr || is_the_same(calibration.flight, flight)) return calibration;
  const JointSetup& setup = probe->setup();
  const JoinedFlight* const known = find_flight(setup, flight);
  Calibration one = calibration;
  one.probe = probe->one();
  one.options = without_own(calibration.options, setup);
  one.fit = fit_on_flight(calibration.fit, setup, known == nullptr ? "" : known->label);
  one.fit.identifiability = {};
  one.departures.clear();
  one.restated = known == nullptr ? std::vector<Restatement>() : one.probe->restate(one.fit);
  if (known != nullptr) one.flight = {known->file, known->sha256, known->rows, known->rows};
  return one;
}

void check_known(const Calibration& calibration, const Flight& flight) {
  std::vector<std::string> unknown;
  for (const Parameter& parameter : calibration.fit.parameters) {
    if (std::isnan(parameter.value)) unknown.push_back(parameter.name);
  }
  if (unknown.empty()) return;
  throw Error(fmt::format(
      "{}: none of the flights that were fitted, and {} {} each flight's own; fit it jointly with "
      "them, or give one of them",
      flight.name(), fmt::join(unknown, ", "), unknown.size() == 1 ? "is" : "are"));
}

Flight rejoin_flights(const Calibration& calibration, const std::vector<Flight>& flights,
                      std::vector<std::string>& notes) {
  const JointSetup* const setup = joint_setup(*calibration.probe);
  if (setup == nullptr) {
    throw Error(fmt::format("the calibration is of one flight; give one, not {}", flights.size()));
  }
  std::vector<Flight> ordered;
  for (const JoinedFlight& one : setup->flights) {
    const auto found = std::ranges::find_if(
        flights, [&](const Flight& flight) { return is_the_same(one, flight); });
    if (found == flights.end()) {
      throw Error(fmt::format(
          "{} is missing, or changed since; give the flights of the fit: {}", one.file,
          fmt::join(setup->flights | std::views::transform(&JoinedFlight::file), ", ")));
    }
    ordered.push_back(*found);
  }
  if (flights.size() != ordered.size()) {
    throw Error(fmt::format("{} flights are given, the calibration is of {}", flights.size(),
                            ordered.size()));
  }
  return join_flights(ordered, calibration.options.log, notes);
}

}  // namespace sepcal
