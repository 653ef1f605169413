// SPDX-License-Identifier: BSD-3-Clause
// The command line that both apps share: verbs, options, exit codes.
#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <csignal>

#include "instrument.hpp"
#include "sepcal/error.hpp"
#include "verbs.hpp"

namespace sepcal::app {
namespace {

constexpr int bad_usage = 2;

/// The whole of `text` as a finite number. Throws Error naming the option.
double parse_value(const std::string& option, const std::string& text) {
  if (const auto value = parse_number(text)) return *value;
  throw Error(fmt::format("{}: '{}' is not a number", option, text));
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// "NAME=VALUE" to its two halves. Throws Error naming the option and the form.
std::pair<std::string, std::string> parse_assignment(const std::string& option,
                                                     const std::string& text,
                                                     const std::string& form) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0) {
    throw Error(fmt::format("{} {}: write it as {}", option, text, form));
  }
  return {text.substr(0, at), text.substr(at + 1)};
}

/// The options of fit as text; what they mean is checked when the verb runs.
struct FitArguments {
  std::vector<std::string> effects;
  std::vector<std::string> bounds;
  std::vector<std::string> fixed;
  std::vector<std::string> noise;
  std::string second_stage = "auto";
  std::string sampling = "uniform";
  CalibrationOptions options;

  void add_to(CLI::App& fit) {
    FitOptions& engine = options.fit;
    fit.add_option("--effect", effects, "adds a physical effect to the model; may be repeated")
        ->type_name("E")
        ->take_all()
        ->allow_extra_args(false);
    fit.add_option("--stage-one", engine.stage_one_segments,
                   "maneuvers or times that stage one uses, e.g. wind_circle_1,510.9:530")
        ->type_name("SEGMENTS");
    fit.add_option("--stage-two", engine.stage_two_segments, "the same for stage two")
        ->type_name("SEGMENTS");
    fit.add_option("--bounds", bounds, "bounds in the parameter's unit; may be repeated")
        ->type_name("NAME=LO,HI")
        ->take_all()
        ->allow_extra_args(false);
    fit.add_option("--fix", fixed, "holds a parameter at a value; may be repeated")
        ->type_name("NAME=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    fit.add_option("--free", options.free, "frees a parameter that is held by default")
        ->type_name("NAME")
        ->take_all()
        ->allow_extra_args(false);
    fit.add_option("--noise", noise, "holds an output's noise at a standard deviation")
        ->type_name("OUTPUT=SD")
        ->take_all()
        ->allow_extra_args(false);
    fit.add_option("--samples", engine.samples, "samples of stage one")
        ->type_name("S")
        ->capture_default_str();
    fit.add_option("--sampling", sampling, "uniform or low_discrepancy")
        ->type_name("HOW")
        ->capture_default_str();
    fit.add_option("--seed", engine.seed, "seed of the samples")
        ->type_name("N")
        ->capture_default_str();
    fit.add_option("--second-stage", second_stage, "joint, projected or auto")
        ->type_name("HOW")
        ->capture_default_str();
    fit.add_option("--noise-tolerance", engine.noise_tolerance,
                   "relative change of R at which R and the parameters have settled")
        ->type_name("T")
        ->capture_default_str();
    fit.add_option("--threads", engine.threads, "threads; 0: one a core")
        ->type_name("N")
        ->capture_default_str();
    fit.add_flag("--drop-invalid", options.drop_invalid,
                 "drops rows with a cell that is no number instead of refusing the file");
  }

  /// Throws Error for a text that doesn't mean anything.
  CalibrationOptions resolve() {
    if (!effects.empty()) {
      throw Error(fmt::format("--effect {}: effects can't be fitted yet; `effects` lists them",
                              effects.front()));
    }
    for (const std::string& text : bounds) {
      const auto [name, interval] = parse_assignment("--bounds", text, "NAME=LO,HI");
      const std::vector<std::string> ends = split(interval, ',');
      if (ends.size() != 2) throw Error("--bounds " + text + ": write it as NAME=LO,HI");
      options.fit.bounds[name] = {parse_value("--bounds", ends[0]),
                                  parse_value("--bounds", ends[1])};
    }
    for (const std::string& text : fixed) {
      const auto [name, value] = parse_assignment("--fix", text, "NAME=VALUE");
      options.fit.fixed[name] = parse_value("--fix", value);
    }
    for (const std::string& text : noise) {
      const auto [name, value] = parse_assignment("--noise", text, "OUTPUT=SD");
      options.fit.noise[name] = parse_value("--noise", value);
    }
    if (options.fit.threads < 0) throw Error("--threads must not be negative");
    options.fit.second_stage = choose<SecondStage>("--second-stage", second_stage,
                                                   {{"auto", SecondStage::automatic},
                                                    {"joint", SecondStage::joint},
                                                    {"projected", SecondStage::projected}});
    options.fit.sampling = choose<Sampling>(
        "--sampling", sampling,
        {{"uniform", Sampling::uniform}, {"low_discrepancy", Sampling::low_discrepancy}});
    return options;
  }

 private:
  template <class Choice>
  static Choice choose(const std::string& option, const std::string& text,
                       const std::vector<std::pair<std::string, Choice>>& choices) {
    std::string known;
    for (const auto& [name, choice] : choices) {
      if (name == text) return choice;
      known += (known.empty() ? "" : ", ") + name;
    }
    throw Error(fmt::format("{} {} is unknown; known: {}", option, text, known));
  }
};

/// CLI11's words for a wrong command line, in one line with the way out.
int refuse_usage(const Instrument& instrument, const CLI::App& cli, const CLI::ParseError& error) {
  std::string what = error.what();
  std::ranges::replace(what, '\n', ' ');
  std::string verb;
  for (const CLI::App* parsed : cli.get_subcommands()) verb = " " + parsed->get_name();
  fmt::print(stderr, "{}: {} (see {}{} --help)\n", instrument.app(), what, instrument.app(), verb);
  return bad_usage;
}

}  // namespace

std::array<double, 3> parse_triple(const std::string& option, const std::string& text) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != 3) {
    throw Error(fmt::format("{} {}: give three numbers, e.g. 0.35,0,-0.02", option, text));
  }
  std::array<double, 3> values{};
  for (std::size_t i = 0; i < 3; ++i) values[i] = parse_value(option, parts[i]);
  return values;
}

int run(Instrument& instrument, int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a full quota is an error to report, not an end
  CLI::App cli(instrument.summary(), instrument.app());
  cli.require_subcommand(1);
  cli.set_version_flag("--version", std::string("sepcal ") + SEPCAL_VERSION);
  cli.footer("Exit codes: 0 done, 2 bad input or usage, 4 not identifiable, 5 did not converge.");

  Arguments arguments;
  FitArguments fit_arguments;
  SimulationOptions simulation;
  const auto add_flight = [&](CLI::App& verb) {
    verb.add_option("FLIGHT", arguments.flight, "the log, a CSV file")->required();
  };
  const auto add_calibration = [&](CLI::App& verb) {
    verb.add_option("CALIBRATION", arguments.calibration, "what fit wrote with -o")->required();
  };
  const auto add_json = [&](CLI::App& verb) {
    verb.add_flag("--json", arguments.json, "prints the result as JSON on standard output");
  };

  CLI::App& fit = *cli.add_subcommand("fit", "fits the model to a flight");
  add_flight(fit);
  fit.add_option("-o,--output", arguments.output, "writes the calibration there")
      ->type_name("BASE.json");
  instrument.add_probe_options(fit);
  fit_arguments.add_to(fit);
  add_json(fit);

  CLI::App& compare = *cli.add_subcommand("compare", "shows where the model fails");
  add_flight(compare);
  add_calibration(compare);
  add_json(compare);

  CLI::App& apply = *cli.add_subcommand("apply", "adds the calibrated readings to a log");
  add_flight(apply);
  add_calibration(apply);
  apply.add_option("-o,--output", arguments.output, "writes the corrected log there")
      ->type_name("CORRECTED.csv")
      ->required();
  add_json(apply);

  CLI::App& simulate = *cli.add_subcommand("simulate", "makes a flight whose truth is known");
  simulate.add_option("-o,--output", arguments.output, "writes the flight there")
      ->type_name("FLIGHT.csv")
      ->required();
  simulate
      .add_option(
          "--truth", arguments.truth,
          "the true parameters: read where the file is there, else written with the defaults")
      ->type_name("T.json");
  simulate.add_option("--seed", simulation.seed, "seed of the noise")
      ->type_name("N")
      ->capture_default_str();
  simulate.add_option("--rate", simulation.rate, "sampling rate [Hz]")
      ->type_name("HZ")
      ->capture_default_str();
  simulate.add_option("--rows", simulation.rows, "a short flight of N rows with every maneuver")
      ->type_name("N");
  add_json(simulate);

  CLI::App& effects = *cli.add_subcommand("effects", "lists the physical effects a model may lack");
  add_json(effects);

  for (const char* name : {"diagnose", "add"}) {
    cli.add_subcommand(name, "not there yet")->allow_extras();
  }

  try {
    cli.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return cli.exit(help);
  } catch (const CLI::ParseError& error) {
    return refuse_usage(instrument, cli, error);
  }

  try {
    const Verbs verbs(instrument, arguments);
    if (fit.parsed()) return verbs.fit(fit_arguments.resolve());
    if (compare.parsed()) return verbs.compare();
    if (apply.parsed()) return verbs.apply();
    if (simulate.parsed()) return verbs.simulate(simulation);
    if (effects.parsed()) return verbs.effects();
    const std::string verb = cli.get_subcommands().front()->get_name();
    throw Error(verb + " is not there yet; compare shows where the model fails");
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", instrument.app(), error.what());
    return bad_usage;
  }
}

}  // namespace sepcal::app
