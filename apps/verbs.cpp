// SPDX-License-Identifier: BSD-3-Clause
#include "verbs.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "delivery.hpp"
#include "diagnose_arguments.hpp"
#include "flight/files/text_file.hpp"
#include "flight/files/written_flight.hpp"
#include "progress.hpp"
#include "running.hpp"
#include "sepcal/detail/flight/certified.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/detail/flight/read_as.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/check.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/export.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"
#include "sepcal/flight/intervals.hpp"
#include "sepcal/flight/residuals.hpp"
#include "terminal.hpp"

namespace sepcal::app {

using base::page;

Flight Verbs::read_flight(const LogChoice& log, int threads) const {
  return read_flight(arguments_.flight, log, threads);
}

Flight Verbs::read_flight(const std::string& file, const LogChoice& log, int threads) const {
  const CsvForm form = arguments_.log.over(log).form();
  return read_told(file, [&](const Progress& show) {
    return arguments_.stream ? stream_csv(file, {}, show, threads, form)
                             : read_csv(file, show, threads, form);
  });
}

std::vector<std::string> Verbs::flight_files() const {
  std::vector<std::string> files{arguments_.flight};
  files.insert(files.end(), arguments_.more_flights.begin(), arguments_.more_flights.end());
  return files;
}

std::vector<std::string> Verbs::input_files() const {
  std::vector<std::string> files = flight_files();
  files.push_back(arguments_.calibration);
  return files;
}

std::vector<Flight> Verbs::read_flights(const LogChoice& log, int threads) const {
  std::vector<Flight> flights;
  for (const std::string& file : flight_files()) flights.push_back(read_flight(file, log, threads));
  return flights;
}

Verbs::Subject Verbs::read_subject() const {
  Calibration calibration = read_base();
  if (arguments_.more_flights.empty()) {
    Flight flight = read_flight(calibration.options.log);
    return {for_flight(calibration, flight), std::move(flight)};
  }
  std::vector<std::string> notes;
  Flight joined = rejoin_flights(calibration, read_flights(calibration.options.log), notes);
  tell_notes(notes);
  return {std::move(calibration), std::move(joined)};
}

Verbs::Subject Verbs::read_whole_subject() const {
  const Calibration calibration = read_base();
  const JointSetup* const joint = joint_setup(*calibration.probe);
  if (joint != nullptr && arguments_.more_flights.empty()) {
    throw Error(fmt::format("{} is of {} flights; give them all", arguments_.calibration,
                            joint->flights.size()));
  }
  return read_subject();
}

Calibration Verbs::read_base() const {
  Calibration calibration = read_calibration(arguments_.calibration, instrument_.app());
  calibration.options.log = arguments_.log.over(std::move(calibration.options.log));
  if (joint_setup(*calibration.probe) == nullptr) {
    calibration.probe = instrument_.probe_for_flight(calibration.probe);
  }
  return calibration;
}

int Verbs::fit(CalibrationOptions options) const {
  Delivery delivery({arguments_.output, arguments_.json, arguments_.explain}, flight_files());
  const std::vector<Flight> flights = read_flights(options.log, options.fit.threads);
  const Flight& flight = flights.front();
  if (flights.size() == 1 && !arguments_.own.empty()) {
    throw Error("--own is of several flights; give them, or leave it out");
  }
  ProgressLine line;
  options.fit.progress = shown_on(line);
  const auto fit_one = [&] {
    return calibrate(instrument_.probe(read_as(flight, options.log).flight), flight, options);
  };
  const auto fit_all = [&] {
    std::vector<std::string> notes;  // calibrate_jointly() gives them with the calibration
    const auto probe = instrument_.probe(join_flights(flights, options.log, notes));
    return calibrate_jointly(probe, flights, arguments_.own, options);
  };
  Calibration calibration = flights.size() == 1 ? fit_one() : fit_all();
  if (arguments_.certify) {
    if (flights.size() > 1) throw Error("--certify is of one flight; fit them one by one");
    const Certificate proof = certify(calibration, flight, {.threads = options.fit.threads});
    calibration.notes.push_back("certificate: " + proof.message);
  }
  line.clear();
  delivery.deliver(calibration);
  return exit_code(calibration.fit.status);
}

int Verbs::check() const {
  Delivery delivery({arguments_.output, arguments_.json, arguments_.explain}, {arguments_.flight});
  const Flight flight = read_flight();
  const LogChoice choice = arguments_.log.over({});
  const auto probe = instrument_.probe(read_as(flight, choice).flight);
  const FlightCheck check = sepcal::check(*probe, flight, choice, as_typed);
  delivery.deliver(to_json(check), to_text(check));
  return 0;
}

int Verbs::compare() const {
  Delivery delivery({arguments_.output, arguments_.json, arguments_.explain}, {});
  const auto [calibration, flight] = read_subject();
  check_known(calibration, flight);
  delivery.deliver(sepcal::compare(calibration, flight, arguments_.references));
  return 0;
}

int Verbs::residuals() const {
  for (const std::string& file : input_files()) check_not_input(arguments_.output, file);
  OutputFile output(arguments_.output);
  const auto [calibration, flight] = read_subject();
  check_known(calibration, flight);
  deliver_residuals(tabulate_residuals(calibration, flight), arguments_.output, output);
  return 0;
}

int Verbs::intervals(ProfileOptions asked) const {
  Delivery delivery({arguments_.output, arguments_.json, arguments_.explain}, input_files());
  const auto [base, flight] = read_whole_subject();
  ProgressLine line;
  asked.progress = shown_on(line);
  const FlightIntervals intervals = find_intervals(base, flight, asked);
  line.clear();
  delivery.deliver(intervals);
  return exit_code(intervals.status);
}

int Verbs::diagnose(const DiagnoseArguments& asked) const {
  Delivery delivery({arguments_.output, arguments_.json, arguments_.explain}, input_files());
  StepwiseOptions options = asked.resolve();
  const std::optional<SizedEffect> injected = asked.injected();
  const auto [base, flight] = read_whole_subject();
  ProgressLine line;
  options.diagnosis.threads = base.options.fit.threads;
  options.diagnosis.progress = shown_on(line);
  if (asked.adds()) {
    const StepwiseCalibration result = diagnose_stepwise(base, flight, {}, options);
    line.clear();
    tell_notes(result.calibration.notes);
    delivery.deliver(to_json(result), to_text(result, detail_of(arguments_.explain)));
    const int fitted = exit_code(result.calibration.fit.status);
    return fitted != 0 ? fitted : exit_code(result.course.last.diagnosis.verdict);
  }
  const FlightDiagnosis diagnosis =
      injected ? diagnose_with(*injected, base, flight, {}, options.diagnosis)
               : sepcal::diagnose(base, flight, {}, options.diagnosis);
  line.clear();
  delivery.deliver(diagnosis);
  return exit_code(diagnosis.diagnosis.verdict);
}

int Verbs::add() const {
  Delivery delivery({arguments_.output, arguments_.json, arguments_.explain}, input_files());
  const auto [base, flight] = read_whole_subject();
  ProgressLine line;
  const Calibration next = sepcal::add(base, flight, arguments_.effect, {}, shown_on(line));
  line.clear();
  delivery.deliver(next);
  return exit_code(next.fit.status);
}

int Verbs::apply() const {
  check_not_input(arguments_.output, arguments_.calibration);
  Calibration calibration = read_base();
  if (joint_setup(*calibration.probe) != nullptr) {
    calibration = for_flight(calibration, read_flight(calibration.options.log));
  }
  ProgressLine line;
  const Applied applied = apply_to_file(
      calibration, arguments_.flight, arguments_.output,
      [&](double fraction) { line.show("reading " + arguments_.flight, fraction); },
      arguments_.stream);
  line.clear();
  tell_notes(applied.notes);
  give(arguments_.json, to_json(applied, calibration),
       to_text(applied, calibration, detail_of(arguments_.explain)));
  return 0;
}

int Verbs::track(const FlightTrackOptions& options) const {
  for (const std::string& file : input_files()) check_not_input(arguments_.output, file);
  OutputFile output(arguments_.output);
  const Calibration calibration = read_base();
  const TrackedFlight tracked =
      sepcal::track(calibration, read_flight(calibration.options.log), options);
  write_csv(tracked, output);
  output.commit();
  tell_notes(tracked.notes);
  give(arguments_.json, to_json(tracked),
       to_text(tracked) + page("wrote {}\n", arguments_.output).text());
  return 0;
}

int Verbs::export_to(ExportOptions options) const {
  check_not_input(arguments_.output, arguments_.calibration);
  const Calibration calibration = read_base();
  std::optional<Flight> flight;
  if (!arguments_.flight.empty()) flight = read_flight(calibration.options.log);
  ProgressLine line;
  options.progress = shown_on(line);
  const Exported exported =
      export_to_file(calibration, flight ? &*flight : nullptr, options, arguments_.output);
  line.clear();
  tell_notes(exported.notes);
  give(arguments_.json, to_json(exported, arguments_.output), to_text(exported, arguments_.output));
  return 0;
}

int Verbs::simulate(SimulationOrder order) const {
  if (!arguments_.truth.empty() && is_same_file(arguments_.output, arguments_.truth)) {
    throw Error(fmt::format("-o {} and --truth {} are one file; name another for one of them",
                            arguments_.output, arguments_.truth));
  }
  OutputFile output(arguments_.output);
  const bool given = is_there(arguments_.truth);
  std::optional<OutputFile> truth;
  if (!arguments_.truth.empty() && !given) truth.emplace(arguments_.truth);
  order.source = given ? arguments_.truth : "simulate";
  if (given) order.truth = files::read_text_file(arguments_.truth, "as a truth file");
  const Simulation simulation = instrument_.simulate(order);
  write_csv(simulation.flight, output.stream());
  output.flush();
  if (truth) {
    truth->write(simulation.truth);
    truth->commit();
  }
  output.commit();
  if (arguments_.json) {
    print(simulation.truth);
  } else {
    show(page("wrote {}: {} rows\n", arguments_.output, simulation.flight.rows()));
    if (!arguments_.truth.empty()) {
      show(page("{} {}: the true parameters\n", given ? "read" : "wrote", arguments_.truth));
    }
  }
  return 0;
}

int Verbs::join() const {
  for (const std::string& input : {arguments_.flight, arguments_.other}) {
    check_not_input(arguments_.output, input);
  }
  OutputFile output(arguments_.output);
  const Flight joined =
      join_rates(read_flight(), read_flight(arguments_.other, {}, 0), arguments_.joining);
  files::write_flight(joined, output);
  output.commit();
  tell_notes(joined.notes());
  show(page("wrote {}: {} rows\n", arguments_.output, joined.rows()));
  show(
      page("next: {} fit {} --effect time_offset estimates what is left between the clocks; add "
           "its tau to --offset\n",
           instrument_.app(), base::file_in_shell(arguments_.output)));
  return 0;
}

int Verbs::effects() const {
  if (arguments_.json) {
    print(catalogue_json(instrument_.models()));
    return 0;
  }
  for (const std::string& model : instrument_.models()) show(catalogue_text(model));
  return 0;
}

}  // namespace sepcal::app
