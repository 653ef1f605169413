// SPDX-License-Identifier: BSD-3-Clause
// The command line that both apps share: verbs, options, exit codes.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>     // what App is made with, in this unit
#include <CLI/Formatter.hpp>  // the same

#include "diagnose_arguments.hpp"
#include "export_arguments.hpp"
#include "fit_arguments.hpp"
#include "instrument.hpp"
#include "interval_arguments.hpp"
#include "option_values.hpp"
#include "running.hpp"
#include "sepcal/fit.hpp"
#include "simulation_arguments.hpp"
#include "tables.hpp"
#include "track_arguments.hpp"
#include "verbs.hpp"

namespace sepcal::app {
namespace {

void add_simulate_options(CLI::App& simulate, Arguments& arguments, Instrument& instrument,
                          SimulationArguments& simulation) {
  add_file(simulate, "-o,--output", arguments.output, "writes the flight there")
      ->type_name("FLIGHT.csv")
      ->required();
  add_file(simulate, "--truth", arguments.truth,
           "the true parameters: read where the file is there, else written with the defaults")
      ->type_name("T.json");
  instrument.add_simulation_options(simulate);
  simulation.add_to(simulate);
}

void add_diagnose_options(CLI::App& diagnose, Arguments& arguments, DiagnoseArguments& asked) {
  add_file(diagnose, "-o,--output", arguments.output,
           "writes the diagnosis there, with --auto the calibration")
      ->type_name("D.json");
  asked.add_to(diagnose);
}

void add_adding_options(CLI::App& add, Arguments& arguments) {
  add.add_option("E", arguments.effect,
                 "the effect, by name or alias; E1+E2 adds both (see effects)")
      ->required();
  add_file(add, "-o,--output", arguments.output, "writes the next calibration there")
      ->type_name("NEXT.json");
}

void add_stream(CLI::App& verb, Arguments& arguments) {
  verb.add_flag("--stream", arguments.stream,
                "takes a log longer than memory: its columns go to nameless files in $TMPDIR");
}

void add_applying_options(CLI::App& apply, Arguments& arguments) {
  add_file(apply, "-o,--output", arguments.output, "writes the corrected log there")
      ->type_name("CORRECTED.csv")
      ->required();
  add_stream(apply, arguments);
}

void add_joining_options(CLI::App& join, Arguments& arguments) {
  add_file(join, "MEASURED", arguments.flight, "the log of the sensor, whose rows stay")
      ->required();
  add_file(join, "OTHER", arguments.other, "the log whose columns are brought to these rows")
      ->required();
  join.add_option("--how", arguments.joining.how,
                  "the value in a row: from a parabola through the nearby samples, from the "
                  "straight line between two, or the earlier one")
      ->type_name("smooth|linear|held")
      ->capture_default_str();
  join.add_option("--offset", arguments.joining.offset, "seconds to add to OTHER's time")
      ->type_name("S")
      ->capture_default_str();
  add_file(join, "-o,--output", arguments.output, "writes the joined log there")
      ->type_name("JOINED.csv")
      ->required();
}

/// The calibration comes first here: most exports need no flight.
void add_exporting_options(CLI::App& verb, Arguments& arguments) {
  add_file(verb, "CALIBRATION", arguments.calibration, "the file that fit or add wrote with -o")
      ->required();
  add_file(verb, "FLIGHT", arguments.flight,
           "the log that it was fitted to, a CSV file [the one that it names]");
  add_file(verb, "-o,--output", arguments.output, "writes what the vehicle loads there")
      ->type_name("FILE")
      ->required();
}

/// The verbs of an app with their options, and what was typed.
class CommandLine {
 public:
  CommandLine(Instrument& instrument, CLI::App& cli)
      : instrument_(instrument),
        cli_(cli),
        check_(cli.add_subcommand("check",
                                  "describes a log and says what each problem does to a fit")),
        fit_(cli.add_subcommand("fit", "fits the model to a flight")),
        compare_(add_later_verb("compare", "shows where the model fails")),
        residuals_(add_later_verb("residuals", "writes the residuals, row by row", true, false)),
        intervals_(add_later_verb("intervals", "gives a confidence interval for each parameter")),
        diagnose_(add_later_verb("diagnose", "names the physical effect that is missing")),
        add_(add_later_verb("add", "adds a physical effect and fits again")),
        apply_(add_later_verb("apply", "adds the calibrated readings to a log", false)),
        track_(add_later_verb("track", "estimates parameters row by row, as in flight", false)),
        export_(cli.add_subcommand("export",
                                   "writes a calibration as a header or autopilot parameters")),
        join_(cli.add_subcommand("join", "brings another log's columns to a sensor's rows")),
        simulate_(cli.add_subcommand("simulate", "simulates a flight with known truth")) {
    add_flight(*check_);
    add_file(*check_, "-o,--output", typed_.output, "writes what is found there")
        ->type_name("C.json");
    add_probe_options(*check_);
    typed_.log.add_log_choice_to(*check_);
    add_json(*check_);

    add_flight(*fit_);
    add_more_flights(*fit_, typed_.more_flights,
                     "more flights, fitted jointly with the first; their names end in .csv");
    add_probe_options(*fit_);
    fit_->option_defaults()->group("The fit");
    fit_->add_option("--own", typed_.own,
                     "with several flights: parameters estimated per flight, e.g. wind")
        ->type_name("NAME[,...]")
        ->delimiter(',')
        ->allow_extra_args(false);
    add_file(*fit_, "-o,--output", typed_.output, "writes the calibration there")
        ->type_name("BASE.json");
    fit_arguments_.add_to(*fit_);
    fit_->add_flag("--certify", typed_.certify,
                   "proves that no cost within the bounds is lower, where one or two nonlinear "
                   "parameters are free");
    add_stream(*fit_, typed_);
    add_explain(*fit_);
    add_json(*fit_);

    instrument.add_flight_options(*compare_);
    add_references(*compare_, typed_.references);
    instrument.add_flight_options(*residuals_);
    add_file(*residuals_, "-o,--output", typed_.output, "writes the table there")
        ->type_name("R.csv")
        ->required();
    intervals_asked_.add_to(*intervals_);
    add_file(*intervals_, "-o,--output", typed_.output, "writes the intervals there")
        ->type_name("I.json");
    add_diagnose_options(*diagnose_, typed_, diagnosis_);
    instrument.add_flight_options(*diagnose_);
    add_adding_options(*add_, typed_);
    instrument.add_flight_options(*add_);
    add_applying_options(*apply_, typed_);
    instrument.add_flight_options(*track_);
    tracking_.add_to_sensor(*track_);
    add_file(*track_, "-o,--output", typed_.output, "writes the estimates there")
        ->type_name("TRACK.csv")
        ->required();

    add_exporting_options(*export_, typed_);
    exporting_.add_to(*export_);
    instrument.add_flight_options(*export_);
    add_json(*export_);

    add_joining_options(*join_, typed_);
    add_simulate_options(*simulate_, typed_, instrument, simulation_);
    add_json(*simulate_);
    add_json(*cli.add_subcommand("effects", "lists the physical effects a model may lack"));
  }

  /// Does what the verb that was typed says, and gives the exit code.
  int perform() {
    const Verbs verbs(instrument_, typed_);
    if (check_->parsed()) return verbs.check();
    if (fit_->parsed()) return verbs.fit(fit_arguments_.resolve());
    if (compare_->parsed()) return verbs.compare();
    if (residuals_->parsed()) return verbs.residuals();
    if (intervals_->parsed()) return verbs.intervals(intervals_asked_.resolve());
    if (add_->parsed()) return verbs.add();
    if (apply_->parsed()) return verbs.apply();
    if (track_->parsed()) return verbs.track(tracking_.resolve());
    if (export_->parsed()) return verbs.export_to(exporting_.resolve());
    if (join_->parsed()) return verbs.join();
    if (simulate_->parsed()) return verbs.simulate(simulation_.resolve());
    if (diagnose_->parsed()) return verbs.diagnose(diagnosis_);
    return verbs.effects();
  }

 private:
  /// A verb that takes a calibration and a flight.
  CLI::App* add_later_verb(const char* name, const char* what, bool of_several = true,
                           bool has_json = true) {
    CLI::App& verb = *cli_.add_subcommand(name, what);
    add_flight(verb);
    if (of_several)
      add_more_flights(verb, typed_.more_flights,
                       "the other flights of a joint fit, names in .csv");
    add_file(verb, "CALIBRATION", typed_.calibration, "the file that fit wrote with -o")
        ->required();
    typed_.log.add_log_choice_to(verb);
    if (has_json) {
      add_explain(verb);
      add_json(verb);
    }
    return &verb;
  }

  void add_flight(CLI::App& verb) {
    add_file(verb, "FLIGHT", typed_.flight, "the log; - is standard input")->required();
  }

  void add_probe_options(CLI::App& verb) {
    verb.option_defaults()->group("The sensor");
    instrument_.add_probe_options(verb);
    verb.option_defaults()->group("Options");
  }

  void add_json(CLI::App& verb) {
    verb.add_flag("-j,--json", typed_.json, "prints the result as JSON on standard output");
  }

  void add_explain(CLI::App& verb) {
    verb.add_flag("--explain", typed_.explain,
                  "prints everything about the fit's status, with reasons, not only the worst");
  }

  Instrument& instrument_;
  CLI::App& cli_;
  Arguments typed_;
  FitArguments fit_arguments_;
  SimulationArguments simulation_;
  DiagnoseArguments diagnosis_;
  IntervalArguments intervals_asked_;
  ExportArguments exporting_;
  TrackArguments tracking_;
  CLI::App* check_;
  CLI::App* fit_;
  CLI::App* compare_;
  CLI::App* residuals_;
  CLI::App* intervals_;
  CLI::App* diagnose_;
  CLI::App* add_;
  CLI::App* apply_;
  CLI::App* track_;
  CLI::App* export_;
  CLI::App* join_;
  CLI::App* simulate_;
};

}  // namespace

int run(Instrument& instrument, const std::string& called, int argc, char** argv) {
  CLI::App cli(instrument.summary(), called);
  CommandLine command_line(instrument, cli);
  return run(cli, argc, argv, [&] { return command_line.perform(); });
}

std::string table_of(Instrument& instrument, const std::string& called) {
  CLI::App cli(instrument.summary(), called);
  const CommandLine command_line(instrument, cli);
  complete(cli);
  return table_of(cli, instrument.models());
}

}  // namespace sepcal::app
