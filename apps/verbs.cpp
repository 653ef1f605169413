// SPDX-License-Identifier: BSD-3-Clause
#include "verbs.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <initializer_list>
#include <optional>

#include "flight/files/text_file.hpp"
#include "progress.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/adding.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/check.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/effect_catalogue.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"
#include "sepcal/flight/intervals.hpp"
#include "sepcal/flight/output_file.hpp"

namespace sepcal::app {
namespace {

/// Prints a result and makes sure that it arrived: a full disc behind a redirection is an error.
void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw Error("standard output can't be written; is the disc full?");
  }
}

void print_notes(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) fmt::print(stderr, "note: {}\n", note);
}

FitProgress shown_on(ProgressLine& line) {
  return [&line](std::string_view task, double fraction) { line.show(task, fraction); };
}

Detail detail_of(const Arguments& arguments) {
  return arguments.explain ? Detail::explained : Detail::brief;
}

/// The way of a result: to -o's file, which is opened before the work, so that one that can't be
/// written is refused at once; then to standard output.
class Delivery {
 public:
  /// Throws Error where -o names one of `inputs` or can't be written.
  Delivery(const Arguments& arguments, std::initializer_list<std::string> inputs)
      : arguments_(arguments) {
    if (arguments.output.empty()) return;
    for (const std::string& input : inputs) check_not_input(arguments.output, input);
    file_.emplace(arguments.output);
  }

  template <class Result>
  void deliver(const Result& result) {
    print_notes(result.notes);
    deliver(to_json(result), to_text(result, detail_of(arguments_)));
  }

  void deliver(const std::string& json, const std::string& page) {
    if (file_) {
      file_->write(json);
      file_->commit();
    }
    print(arguments_.json ? json : page);
    if (file_ && !arguments_.json) print(fmt::format("wrote {}\n", arguments_.output));
  }

 private:
  const Arguments& arguments_;
  std::optional<OutputFile> file_;
};

int exit_code(FitStatus status) {
  switch (status) {
    case FitStatus::converged:
      return 0;
    case FitStatus::not_identifiable:
      return 4;
    default:
      return 5;
  }
}

int exit_code(Verdict verdict) {
  switch (verdict) {
    case Verdict::adequate:
      return 0;
    case Verdict::effect_missing:
      return 3;
    default:
      return 6;
  }
}

}  // namespace

Flight Verbs::read_flight() const {
  ProgressLine line;
  return read_csv(arguments_.flight,
                  [&](double fraction) { line.show("reading " + arguments_.flight, fraction); });
}

Calibration Verbs::read_base() const {
  Calibration calibration = read_calibration(arguments_.calibration, instrument_.app());
  if (arguments_.drop_invalid) calibration.options.drop_invalid = true;
  calibration.probe = instrument_.probe_for_flight(calibration.probe);
  return calibration;
}

int Verbs::fit(CalibrationOptions options) const {
  Delivery delivery(arguments_, {arguments_.flight});
  const Flight flight = read_flight();
  ProgressLine line;
  options.fit.progress = shown_on(line);
  const Calibration calibration = calibrate(instrument_.probe(flight), flight, options);
  line.clear();
  delivery.deliver(calibration);
  return exit_code(calibration.fit.status);
}

int Verbs::check() const {
  Delivery delivery(arguments_, {arguments_.flight});
  const Flight flight = read_flight();
  const FlightCheck check = sepcal::check(*instrument_.probe(flight), flight);
  delivery.deliver(to_json(check), to_text(check));
  return 0;
}

int Verbs::compare() const {
  Delivery delivery(arguments_, {});
  const Calibration calibration = read_base();
  delivery.deliver(sepcal::compare(calibration, read_flight()));
  return 0;
}

int Verbs::intervals() const {
  Delivery delivery(arguments_, {arguments_.flight, arguments_.calibration});
  const Calibration base = read_base();
  const Flight flight = read_flight();
  ProgressLine line;
  const FlightIntervals intervals = find_intervals(
      base, flight,
      {.level = arguments_.level, .names = arguments_.parameters, .progress = shown_on(line)});
  line.clear();
  delivery.deliver(intervals);
  return exit_code(intervals.status);
}

int Verbs::diagnose() const {
  Delivery delivery(arguments_, {arguments_.flight, arguments_.calibration});
  std::optional<SizedEffect> injected;
  if (!arguments_.inject.empty()) injected = parse_sized_effect(arguments_.inject, "--inject");
  const Calibration base = read_base();
  const Flight flight = read_flight();
  ProgressLine line;
  DiagnosisOptions options;
  options.threads = base.options.fit.threads;
  options.progress = shown_on(line);
  const FlightDiagnosis diagnosis = injected ? diagnose_with(*injected, base, flight, {}, options)
                                             : sepcal::diagnose(base, flight, {}, options);
  line.clear();
  delivery.deliver(diagnosis);
  return exit_code(diagnosis.diagnosis.verdict);
}

int Verbs::add() const {
  Delivery delivery(arguments_, {arguments_.flight});
  const Calibration base = read_base();
  const Flight flight = read_flight();
  ProgressLine line;
  const Calibration next = sepcal::add(base, flight, arguments_.effect, {}, shown_on(line));
  line.clear();
  delivery.deliver(next);
  return exit_code(next.fit.status);
}

int Verbs::apply() const {
  check_not_input(arguments_.output, arguments_.calibration);
  const Calibration calibration = read_base();
  ProgressLine line;
  const Applied applied =
      apply_to_file(calibration, arguments_.flight, arguments_.output,
                    [&](double fraction) { line.show("reading " + arguments_.flight, fraction); });
  line.clear();
  print_notes(applied.notes);
  print(arguments_.json ? to_json(applied, calibration)
                        : to_text(applied, calibration, detail_of(arguments_)));
  return 0;
}

int Verbs::simulate(SimulationOrder order) const {
  if (!arguments_.truth.empty() && is_same_file(arguments_.output, arguments_.truth)) {
    throw Error(fmt::format("-o {} and --truth {} are one file; name another for one of them",
                            arguments_.output, arguments_.truth));
  }
  OutputFile output(arguments_.output);
  const bool given = !arguments_.truth.empty() && std::filesystem::exists(arguments_.truth);
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
    print(fmt::format("wrote {}: {} rows\n", arguments_.output, simulation.flight.rows()));
    if (!arguments_.truth.empty()) {
      print(
          fmt::format("{} {}: the true parameters\n", given ? "read" : "wrote", arguments_.truth));
    }
  }
  return 0;
}

int Verbs::effects() const {
  if (arguments_.json) {
    print(catalogue_json(instrument_.models()));
    return 0;
  }
  for (const std::string& model : instrument_.models()) print(catalogue_text(model));
  return 0;
}

}  // namespace sepcal::app
