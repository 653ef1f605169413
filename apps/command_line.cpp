// SPDX-License-Identifier: BSD-3-Clause
// The command line that both apps share: verbs, options, exit codes.
#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <csignal>
#include <new>

#include "fit_arguments.hpp"
#include "instrument.hpp"
#include "option_values.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/csv.hpp"
#include "sepcal/option_error.hpp"
#include "sepcal/solver_log.hpp"
#include "simulation_arguments.hpp"
#include "verbs.hpp"

namespace sepcal::app {
namespace {

constexpr int bad_usage = 2;

std::string list_verbs(const CLI::App& cli) {
  std::string list;
  for (const CLI::App* verb : cli.get_subcommands({})) {
    list += (list.empty() ? "" : ", ") + verb->get_name();
  }
  return list;
}

/// "--field 20.1 0.9 43.5" leaves two numbers over: said where numbers alone are.
std::string explain_extras(const CLI::App& verb, const CLI::ParseError& error) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) == nullptr) return "";
  const auto is_number = [](std::string_view word) {
    if (word.ends_with(',')) word.remove_suffix(1);
    return parse_number(word).has_value();
  };
  const bool numbers = std::ranges::all_of(verb.remaining(), is_number);
  return numbers ? "; put commas and no blanks between an option's numbers" : "";
}

/// What is wrong with a command line; CLI11's words where a verb was given.
std::string describe(const CLI::App& cli, const CLI::ParseError& error) {
  if (!cli.get_subcommands().empty()) {
    std::string what = error.what();
    std::ranges::replace(what, '\n', ' ');
    return what + explain_extras(*cli.get_subcommands().front(), error);
  }
  const std::vector<std::string> words = cli.remaining();
  return (words.empty() ? "a verb is missing" : fmt::format("'{}' is no verb", words.front())) +
         "; the verbs are: " + list_verbs(cli);
}

int refuse_usage(const Instrument& instrument, const CLI::App& cli, const CLI::ParseError& error) {
  std::string command = instrument.app();
  for (const CLI::App* verb : cli.get_subcommands()) command += " " + verb->get_name();
  fmt::print(stderr, "{}: {} (see {} --help)\n", instrument.app(), describe(cli, error), command);
  return bad_usage;
}

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

void add_interval_options(CLI::App& intervals, Arguments& arguments) {
  intervals
      .add_option("--level", arguments.level,
                  "how often an interval should hold the true value [0.95]")
      ->type_name("LEVEL");
  intervals
      .add_option("--parameter", arguments.parameters, "only this one; may be given several times")
      ->type_name("NAME")
      ->allow_extra_args(false);
  add_file(intervals, "-o,--output", arguments.output, "writes the intervals there")
      ->type_name("I.json");
}

void add_diagnose_options(CLI::App& diagnose, Arguments& arguments) {
  add_file(diagnose, "-o,--output", arguments.output, "writes the diagnosis there")
      ->type_name("D.json");
  diagnose
      .add_option("--inject", arguments.inject,
                  "puts an effect into the measurements first: would it have been found?")
      ->type_name("E=SIZE");
}

void add_adding_options(CLI::App& add, Arguments& arguments) {
  add.add_option("E", arguments.effect,
                 "the effect, by name or alias; E1+E2 adds both (see effects)")
      ->required();
  add_file(add, "-o,--output", arguments.output, "writes the next calibration there")
      ->type_name("NEXT.json");
}

void add_applying_options(CLI::App& apply, Arguments& arguments) {
  add_file(apply, "-o,--output", arguments.output, "writes the corrected log there")
      ->type_name("CORRECTED.csv")
      ->required();
}

/// An option as it is typed here: "--drop-invalid".
std::string as_typed(const std::string& name) {
  std::string option = "--" + name;
  std::ranges::replace(option, '_', '-');
  return option;
}

/// The verbs of an app with their options, and what was typed.
class CommandLine {
 public:
  CommandLine(Instrument& instrument, CLI::App& cli)
      : instrument_(instrument),
        cli_(cli),
        check_(cli.add_subcommand("check", "says what a log is, and what that does to a fit")),
        fit_(cli.add_subcommand("fit", "fits the model to a flight")),
        compare_(add_later_verb("compare", "shows where the model fails")),
        intervals_(
            add_later_verb("intervals", "says how far each parameter may lie, by the likelihood")),
        diagnose_(add_later_verb("diagnose", "names the physical effect that is missing")),
        add_(add_later_verb("add", "adds a physical effect and fits again")),
        apply_(add_later_verb("apply", "adds the calibrated readings to a log")),
        simulate_(cli.add_subcommand("simulate", "makes a flight whose truth is known")) {
    add_flight(*check_);
    add_file(*check_, "-o,--output", typed_.output, "writes what is found there")
        ->type_name("C.json");
    instrument.add_probe_options(*check_);
    add_json(*check_);

    add_flight(*fit_);
    add_file(*fit_, "-o,--output", typed_.output, "writes the calibration there")
        ->type_name("BASE.json");
    instrument.add_probe_options(*fit_);
    fit_arguments_.add_to(*fit_);
    add_explain(*fit_);
    add_json(*fit_);

    instrument.add_flight_options(*compare_);
    add_interval_options(*intervals_, typed_);
    add_diagnose_options(*diagnose_, typed_);
    instrument.add_flight_options(*diagnose_);
    add_adding_options(*add_, typed_);
    instrument.add_flight_options(*add_);
    add_applying_options(*apply_, typed_);

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
    if (intervals_->parsed()) return verbs.intervals();
    if (add_->parsed()) return verbs.add();
    if (apply_->parsed()) return verbs.apply();
    if (simulate_->parsed()) return verbs.simulate(simulation_.resolve());
    if (diagnose_->parsed()) return verbs.diagnose();
    return verbs.effects();
  }

 private:
  /// A verb that takes a calibration and a flight.
  CLI::App* add_later_verb(const char* name, const char* what) {
    CLI::App& verb = *cli_.add_subcommand(name, what);
    add_flight(verb);
    add_file(verb, "CALIBRATION", typed_.calibration, "what fit wrote with -o")->required();
    verb.add_flag("--drop-invalid", typed_.drop_invalid,
                  "drops rows with a cell that is no number, whatever the calibration's fit did");
    add_explain(verb);
    add_json(verb);
    return &verb;
  }

  void add_flight(CLI::App& verb) {
    add_file(verb, "FLIGHT", typed_.flight, "the log, a CSV file")->required();
  }

  void add_json(CLI::App& verb) {
    verb.add_flag("--json", typed_.json, "prints the result as JSON on standard output");
  }

  void add_explain(CLI::App& verb) {
    verb.add_flag("--explain", typed_.explain,
                  "prints all that the fit says of its status, with reasons, not the worst alone");
  }

  Instrument& instrument_;
  CLI::App& cli_;
  Arguments typed_;
  FitArguments fit_arguments_;
  SimulationArguments simulation_;
  CLI::App* check_;
  CLI::App* fit_;
  CLI::App* compare_;
  CLI::App* intervals_;
  CLI::App* diagnose_;
  CLI::App* add_;
  CLI::App* apply_;
  CLI::App* simulate_;
};

}  // namespace

int run(Instrument& instrument, int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a full quota is an error to report, not an end
  silence_solver_log();
  CLI::App cli(instrument.summary(), instrument.app());
  cli.require_subcommand(1);
  cli.set_version_flag("--version", std::string("sepcal ") + SEPCAL_VERSION);
  cli.footer(
      "Exit codes: 0 done, 2 bad input or usage, 3 an effect is missing, 4 not identifiable,\n"
      "5 did not converge, 6 something is missing that no candidate explains.");
  CommandLine command_line(instrument, cli);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return cli.exit(help);
  } catch (const CLI::ParseError& error) {
    return refuse_usage(instrument, cli, error);
  }

  const auto refuse = [&](const std::string& what) {
    fmt::print(stderr, "{}: {}\n", instrument.app(), what);
    return bad_usage;
  };
  try {
    return command_line.perform();
  } catch (const std::bad_alloc&) {
    return refuse("memory ran out; take fewer --samples or --rows, or a shorter log");
  } catch (const OptionError& error) {
    return refuse(error.spelled(as_typed));
  } catch (const std::exception& error) {
    return refuse(error.what());
  }
}

}  // namespace sepcal::app
