// SPDX-License-Identifier: BSD-3-Clause
// sepcal-aircraft: flight paths and aerodynamic coefficients from flight logs.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>     // what App is made with, in this unit
#include <CLI/Formatter.hpp>  // the same
#include <algorithm>

#include <map>
#include <optional>

#include "delivery.hpp"
#include "diagnose_arguments.hpp"
#include "fit_arguments.hpp"
#include "flight/files/text_file.hpp"
#include "interval_arguments.hpp"
#include "option_values.hpp"
#include "programs.hpp"
#include "progress.hpp"
#include "running.hpp"
#include "sepcal/detail/flight/aircraft_file.hpp"
#include "sepcal/detail/simulation/truth.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/aircraft.hpp"
#include "sepcal/flight/expected_fit.hpp"
#include "sepcal/flight/frequency.hpp"
#include "sepcal/simulation/aircraft.hpp"
#include "simulation_arguments.hpp"
#include "tables.hpp"
#include "terminal.hpp"
#include "track_arguments.hpp"

namespace sepcal::app {
using base::page;

namespace {

constexpr const char* summary =
    "Finds flight paths, sensors' errors and aerodynamic coefficients in flight logs.";

std::vector<std::string> split_names(const std::string& text) {
  return text.empty() ? std::vector<std::string>{} : split(text, ',');
}

/// What is fitted and how it is laid along the flight, as text until the command line is whole.
class ModelArguments {
 public:
  void add_model_to(CLI::App& verb) {
    verb.add_option("--model", model_,
                    "path: flight path reconstruction; longitudinal, lateral, six-dof: the "
                    "aircraft; aero: its coefficients by equation error")
        ->type_name("MODEL")
        ->required();
  }

  AircraftModel model() const { return find_aircraft_model(model_); }

  void add_to_fit(CLI::App& verb) {
    add_model_to(verb);
    verb.add_option("--method", method_,
                    "output-error: integrates the states; filter-error: also estimates the size of "
                    "noise that drives them; frequency: fits over a band, by equation error for "
                    "aero and by output error for an aircraft")
        ->type_name("HOW")
        ->capture_default_str();
    verb.add_option("--band", band_,
                    "the band for --method frequency [Hz]; otherwise 0.1:2, the motions of a rigid "
                    "aircraft")
        ->type_name("LOW:HIGH");
    verb.add_option("--spacing", spacing_,
                    "the step between its frequencies [Hz]; otherwise one over the length of a "
                    "segment")
        ->type_name("HZ");
    verb.add_option("--hessian", hessian_,
                    "the information matrix for filter error's standard errors: fisher or observed")
        ->type_name("WHICH")
        ->capture_default_str();
  }

  /// The file of it, or empty.
  const std::string& geometry() const { return geometry_; }

  void add_to(CLI::App& verb) {
    add_file(verb, "--geometry", geometry_,
             "the aircraft: area_m2, chord_m, span_m, mass_kg, inertia_kgm2 ...")
        ->type_name("AIRCRAFT.json");
    verb.add_option("--equation", equations_,
                    "replaces a coefficient's own regressors; --model aero then fits only these "
                    "coefficients; may be repeated")
        ->type_name("C=1,X,...")
        ->take_all()
        ->allow_extra_args(false);
    verb.add_option("--inputs", inputs_, "how inputs change between rows: linear or hold")
        ->type_name("HOW")
        ->capture_default_str();
    verb.add_option("--measured", measured_, "states read from the log instead of integrated")
        ->type_name("v,phi,psi");
    verb.add_option("--outputs", outputs_,
                    "the outputs compared with the log; otherwise all that are logged")
        ->type_name("NAMES");
    verb.add_option("--shoot", shoot_, "cuts segments every T seconds, each with its own start")
        ->type_name("T");
    verb.add_option("--substeps", options_.trajectory.substeps, "integration steps from row to row")
        ->type_name("N")
        ->capture_default_str();
    verb.add_flag("--scale-about-start", options_.trajectory.scales_about_start,
                  "scales multiply the change since the segment's start, as SIDPAC has them");
    verb.add_flag("--position", options_.position,
                  "for path: also integrates the position and compares it with north_m, east_m "
                  "and down_m, or with lat, lon and altitude");
    verb.add_option("--gravity", options_.gravity, "gravity at the place of the flight [m/s^2]")
        ->type_name("G")
        ->capture_default_str();
    verb.add_option("--window", options_.window,
                    "window of the local cubic that differentiates rates [s]; 0: seven rows")
        ->type_name("T")
        ->capture_default_str();
  }

  AircraftOptions resolve(CalibrationOptions calibration) const {
    AircraftOptions options = options_;
    options.model = find_aircraft_model(model_);
    if (!geometry_.empty()) options.geometry = read_aircraft(geometry_);
    for (const std::string& text : equations_) options.equations.push_back(parse_equation(text));
    if (inputs_ != "linear" && inputs_ != "hold") {
      throw Error(fmt::format("--inputs {}: choose linear or hold", inputs_));
    }
    options.trajectory.inputs =
        inputs_ == "hold" ? InputsBetweenRows::hold : InputsBetweenRows::linear;
    options.trajectory.measured = split_names(measured_);
    options.trajectory.outputs = split_names(outputs_);
    if (shoot_) options.trajectory.shoot = *shoot_;
    options.calibration = std::move(calibration);
    options.band = resolve_band();
    if (!options.band) {
      options.calibration.fit.method = choice_of<FitMethod>("--method", method_);
    }
    options.calibration.fit.hessian = choice_of<Hessian>("--hessian", hessian_);
    if (options.model == AircraftModel::aero &&
        options.calibration.fit.method == FitMethod::filter_error) {
      throw Error(
          "--model aero is fitted by equation error; filter error is for path, longitudinal, "
          "lateral and six-dof");
    }
    return options;
  }

 private:
  /// None where the fit is in time.
  std::optional<Band> resolve_band() const {
    const bool is_over_band = method_ == "frequency";
    if (!is_over_band && (!band_.empty() || spacing_)) {
      throw Error(fmt::format("{} is of a fit over a band; give --method frequency with it",
                              band_.empty() ? "--spacing" : "--band"));
    }
    if (!is_over_band) return std::nullopt;
    Band band = parse_band(band_);
    if (spacing_) band.spacing = *spacing_;
    check_band(band);
    return band;
  }

  std::string model_ = "aero";
  std::string method_ = std::string(to_string(FitMethod::output_error));
  std::string hessian_ = std::string(to_string(Hessian::fisher));
  std::string geometry_;
  std::string inputs_ = "linear";
  std::string measured_;
  std::string outputs_;
  std::vector<std::string> equations_;
  std::string band_;
  std::optional<double> spacing_;
  std::optional<double> shoot_;
  AircraftOptions options_;
};

/// A frequency response from columns to a column.
class ResponseArguments {
 public:
  void add_to(CLI::App& verb) {
    verb.add_option("--input", inputs_,
                    "an input, by its header in the log; with several, each is allowed for in the "
                    "others; may be repeated")
        ->type_name("COLUMN")
        ->take_all()
        ->allow_extra_args(false)
        ->required();
    verb.add_option("--of", output_, "the output that responds to the inputs")
        ->type_name("COLUMN")
        ->required();
    verb.add_option("--band", band_, "the band of frequencies [Hz]; otherwise 0.1:2")
        ->type_name("LOW:HIGH");
    verb.add_option("--spacing", options_.band.spacing,
                    "the step between frequencies [Hz]; 0: one over the window")
        ->type_name("HZ")
        ->capture_default_str();
    verb.add_option(
            "--window", options_.window,
            "length of the windows that are averaged [s]; 0: a fifth of the longest segment")
        ->type_name("T")
        ->capture_default_str();
    verb.add_option("--level", options_.level, "confidence level of the ranges")
        ->type_name("P")
        ->capture_default_str();
  }

  FlightResponse find(const Flight& flight, const LogChoice& log) const {
    ResponseOptions options = options_;
    const Band band = parse_band(band_);
    options.band.low = band.low;
    options.band.high = band.high;
    return find_response(flight, inputs_, output_, options, log);
  }

 private:
  std::vector<std::string> inputs_;
  std::string output_;
  std::string band_;
  ResponseOptions options_;
};

/// Inputs to be flown.
class DesignArguments {
 public:
  void add_to(CLI::App& verb) {
    verb.add_option("--input", inputs_,
                    "a surface's column and its largest deflection, in the column's unit; may be "
                    "repeated")
        ->type_name("COLUMN=SIZE")
        ->take_all()
        ->allow_extra_args(false)
        ->required();
    verb.add_option("--signal", signal_,
                    "multisine: sums of sines, orthogonal between inputs; 3-2-1-1: steps of one "
                    "input")
        ->type_name("WHICH")
        ->capture_default_str();
    verb.add_option("--band", band_, "the band to excite [Hz]; otherwise 0.1:2")
        ->type_name("LOW:HIGH");
    verb.add_option("--duration", multisines_.duration, "length of a multisine [s]")
        ->type_name("T")
        ->capture_default_str();
    verb.add_option("--rate", multisines_.rate, "rows a second")
        ->type_name("HZ")
        ->capture_default_str();
    verb.add_flag("--schroeder", schroeder_,
                  "takes phases by Schroeder's formula instead of those with the smallest peak "
                  "factor");
    verb.add_option("--before", steps_.before, "rest before steps [s]")
        ->type_name("T")
        ->capture_default_str();
    verb.add_option("--after", steps_.after, "rest after steps [s]")
        ->type_name("T")
        ->capture_default_str();
  }

  InputDesign design() const {
    Amplitudes amplitudes;
    for (const std::string& text : inputs_) {
      const auto [name, value] = parse_assignment("--input", text, "COLUMN=SIZE");
      amplitudes.emplace_back(name, parse_value("--input", value));
    }
    if (signal_ == "multisine") {
      MultisineOptions options = multisines_;
      options.band = parse_band(band_);
      options.optimised = !schroeder_;
      return design_multisines(amplitudes, options);
    }
    if (signal_ != "3-2-1-1") {
      throw Error(fmt::format("--signal {}: choose multisine or 3-2-1-1", signal_));
    }
    StepsOptions options = steps_;
    options.band = parse_band(band_);
    options.rate = multisines_.rate;
    return design_steps(amplitudes, options);
  }

 private:
  std::vector<std::string> inputs_;
  std::string signal_ = "multisine";
  std::string band_;
  bool schroeder_ = false;
  MultisineOptions multisines_;
  StepsOptions steps_;
};

class AircraftApp {
 public:
  explicit AircraftApp(CLI::App& cli)
      : check_(*cli.add_subcommand("check",
                                   "describes a log and says what each problem does to a fit")),
        fit_(*cli.add_subcommand("fit", "fits a flight path or an aircraft to a flight")),
        two_step_(*cli.add_subcommand("two-step",
                                      "reconstructs the path, then fits the aerodynamics to it")),
        compare_(*cli.add_subcommand("compare", "shows where the model fails")),
        residuals_(*cli.add_subcommand("residuals", "writes the residuals, row by row")),
        intervals_(
            *cli.add_subcommand("intervals", "gives a confidence interval for each parameter")),
        diagnose_(*cli.add_subcommand("diagnose", "names the effect or regressor that is missing")),
        add_(*cli.add_subcommand("add", "adds an effect and fits again")),
        apply_(*cli.add_subcommand("apply", "adds what was flown to a log")),
        track_(*cli.add_subcommand("track", "estimates against time, as a filter in flight")),
        response_(*cli.add_subcommand("response", "finds frequency responses without a model")),
        design_(*cli.add_subcommand("design", "makes inputs to be flown")),
        simulate_(*cli.add_subcommand("simulate", "simulates a flight with known truth")),
        effects_(
            *cli.add_subcommand("effects", "lists effects, regressors and how to write more")) {
    for (CLI::App* verb : {&check_, &fit_, &two_step_, &compare_, &residuals_, &intervals_,
                           &diagnose_, &add_, &apply_, &track_, &response_}) {
      add_flight(*verb);
    }
    add_more_flights(fit_, more_flights_, "other flights, fitted together with it; names in .csv");
    for (CLI::App* verb : {&compare_, &residuals_, &intervals_, &diagnose_, &add_}) {
      add_more_flights(*verb, more_flights_,
                       "the other flights of a fit of several; names in .csv");
    }
    model_.add_model_to(check_);
    fit_arguments_.add_log_choice_to(check_);
    model_.add_to_fit(fit_);
    for (CLI::App* verb : {&fit_, &two_step_}) {
      model_.add_to(*verb);
      fit_arguments_.add_to(*verb);
      add_output(*verb, "BASE.json", false);
    }
    for (CLI::App* verb :
         {&compare_, &residuals_, &intervals_, &diagnose_, &add_, &apply_, &track_}) {
      add_file(*verb, "FIT", base_, "the file that fit wrote with -o")->required();
    }
    for (CLI::App* verb : {&fit_, &two_step_, &apply_, &track_}) {
      add_deviations(
          *verb, "--process-noise", process_noise_,
          "root of the spectral density of a noise that drives the states, in the unit "
          "of the model's table (for ax of a path m/s^2/sqrt(Hz)); a fit allows for it "
          "in its intervals, and filter error holds it at this size; apply adds smoothed "
          "states; may be repeated");
    }
    tracking_.add_to_aircraft(track_);
    add_deviations(track_, "--initial-state", initial_states_,
                   "standard deviation of a state at the start of a segment; otherwise "
                   "practically unknown; may be repeated");
    add_.add_option("E", effect_, "the effect: Cm[alpha^2], imu_late (see effects)")->required();
    add_output(check_, "C.json", false);
    add_output(compare_, "COMPARED.json", false);
    add_references(compare_, references_);
    add_output(residuals_, "R.csv", true);
    add_output(intervals_, "I.json", false);
    profiles_.add_to(intervals_);
    add_output(diagnose_, "D.json", false);
    diagnosis_.add_to(diagnose_);
    add_output(add_, "NEXT.json", false);
    add_output(apply_, "CORRECTED.csv", true);
    add_output(track_, "TRACK.csv", true);
    fit_arguments_.add_log_choice_to(response_);
    response_arguments_.add_to(response_);
    add_output(response_, "RESPONSE.csv", true);
    design_arguments_.add_to(design_);
    add_file(design_, "--for", base_,
             "an aircraft's fit: predicts the standard errors that a flight with these "
             "inputs would give")
        ->type_name("FIT.json");
    add_file(design_, "--flight", flight_,
             "with --for: the log in whose first row the aircraft starts")
        ->type_name("FLIGHT.csv");
    add_output(design_, "INPUT.csv", true);
    add_output(simulate_, "FLIGHT.csv", true);
    add_file(simulate_, "--truth", truth_,
             "the true parameters: read where the file is there, else written with the defaults")
        ->type_name("T.json");
    add_file(simulate_, "--geometry", geometry_, "writes the aircraft there, as fit takes it")
        ->type_name("AIRCRAFT.json");
    simulation_.add_to(simulate_);
    for (CLI::App* verb : {&check_, &fit_, &two_step_, &compare_, &intervals_, &diagnose_, &add_,
                           &apply_, &track_, &response_, &design_, &simulate_, &effects_}) {
      verb->add_flag("-j,--json", wishes_.json, "prints the result as JSON on standard output");
    }
    for (CLI::App* verb :
         {&fit_, &two_step_, &compare_, &intervals_, &diagnose_, &add_, &design_}) {
      verb->add_flag("--explain", wishes_.explain, "prints everything about the fit's status");
    }
  }

  int perform() const {
    if (check_.parsed()) return check();
    if (fit_.parsed()) return fit();
    if (two_step_.parsed()) return two_step();
    if (compare_.parsed()) return compare();
    if (residuals_.parsed()) return residuals();
    if (intervals_.parsed()) return intervals();
    if (diagnose_.parsed()) return diagnose();
    if (add_.parsed()) return add();
    if (apply_.parsed()) return apply();
    if (track_.parsed()) return track();
    if (response_.parsed()) return response();
    if (design_.parsed()) return design();
    if (simulate_.parsed()) return simulate();
    give(wishes_.json, aircraft_effects_json(), aircraft_effects_text());
    return 0;
  }

 private:
  void add_flight(CLI::App& verb) {
    add_file(verb, "FLIGHT", flight_, "the log; - is standard input")->required();
  }

  void add_output(CLI::App& verb, const char* type, bool required) {
    add_file(verb, "-o,--output", wishes_.output, "writes the result there")
        ->type_name(type)
        ->required(required);
  }

  static Flight read_flight(const std::string& file, const LogChoice& log) {
    return read_told(file,
                     [&](const Progress& show) { return read_csv(file, show, 0, log.form()); });
  }

  Flight read_flight(const LogChoice& log) const { return read_flight(flight_, log); }

  /// All that were given as one; in the order of a fit that there is already.
  Flight read_flights(const LogChoice& log, const AircraftFit* fitted = nullptr) const {
    if (more_flights_.empty()) return read_flight(log);
    std::vector<Flight> flights{read_flight(log)};
    for (const std::string& file : more_flights_) flights.push_back(read_flight(file, log));
    std::vector<std::string> notes;
    Flight joined = join_aircraft_flights(std::move(flights), log, notes, fitted);
    tell_notes(notes);
    return joined;
  }

  Flight read_flights(const AircraftFit& base) const {
    return read_flights(base.options.calibration.log, &base);
  }

  std::vector<std::string> input_files(const std::string& other) const {
    std::vector<std::string> files{flight_, other};
    files.insert(files.end(), more_flights_.begin(), more_flights_.end());
    return files;
  }

  AircraftOptions resolve_fit() const {
    AircraftOptions options = model_.resolve(fit_arguments_.resolve());
    options.calibration.fit.process_noise = parse_deviations("--process-noise", process_noise_);
    return options;
  }

  int check() const {
    Delivery delivery(wishes_, {flight_});
    const FlightCheck check = check_aircraft(model_.model(), read_flight(fit_arguments_.over({})),
                                             fit_arguments_.over({}), as_typed);
    delivery.deliver(to_json(check), to_text(check));
    return 0;
  }

  int fit() const {
    Delivery delivery(wishes_, input_files(model_.geometry()));
    AircraftOptions options = resolve_fit();
    const Flight flight = read_flights(options.calibration.log);
    ProgressLine line;
    options.calibration.fit.progress = shown_on(line);
    const AircraftFit fitted = fit_aircraft(flight, options);
    line.clear();
    delivery.deliver(fitted);
    return exit_code(fitted.fit.status);
  }

  int two_step() const {
    Delivery delivery(wishes_, {flight_, model_.geometry()});
    const AircraftOptions options = resolve_fit();
    const TwoStepFit fitted = fit_two_steps(read_flight(options.calibration.log), options);
    delivery.deliver(fitted);
    return std::max(exit_code(fitted.path.fit.status), exit_code(fitted.aero.fit.status));
  }

  int compare() const {
    Delivery delivery(wishes_, input_files(base_));
    const AircraftFit base = read_aircraft_fit(base_);
    delivery.deliver(compare_aircraft(base, read_flights(base), references_));
    return 0;
  }

  int residuals() const {
    for (const std::string& file : input_files(base_)) check_not_input(wishes_.output, file);
    OutputFile output(wishes_.output);
    const AircraftFit base = read_aircraft_fit(base_);
    const Flight flight = read_flights(base);
    deliver_residuals(tabulate_residuals(compare_aircraft(base, flight), flight,
                                         base.options.calibration.log, base.fit.noise),
                      wishes_.output, output);
    return 0;
  }

  int intervals() const {
    Delivery delivery(wishes_, input_files(base_));
    const AircraftFit base = read_aircraft_fit(base_);
    ProfileOptions asked = profiles_.resolve();
    const Flight flight = read_flights(base);
    ProgressLine line;
    asked.progress = shown_on(line);
    const FlightIntervals intervals = find_aircraft_intervals(base, flight, asked);
    line.clear();
    delivery.deliver(intervals);
    return exit_code(intervals.status);
  }

  int diagnose() const {
    Delivery delivery(wishes_, input_files(base_));
    StepwiseOptions options = diagnosis_.resolve();
    const std::optional<SizedEffect> injected = diagnosis_.injected();
    const AircraftFit base = read_aircraft_fit(base_);
    const Flight flight = read_flights(base);
    ProgressLine line;
    options.diagnosis.threads = base.options.calibration.fit.threads;
    options.diagnosis.progress = shown_on(line);
    if (diagnosis_.adds()) {
      const StepwiseAircraft result = diagnose_aircraft_stepwise(base, flight, options);
      line.clear();
      tell_notes(result.fitted.notes);
      delivery.deliver(to_json(result), to_text(result, detail_of(wishes_.explain)));
      const int fitted = exit_code(result.fitted.fit.status);
      return fitted != 0 ? fitted : exit_code(result.course.last.diagnosis.verdict);
    }
    const FlightDiagnosis diagnosis =
        injected ? diagnose_aircraft_with(*injected, base, flight, options.diagnosis)
                 : diagnose_aircraft(base, flight, options.diagnosis);
    line.clear();
    delivery.deliver(diagnosis);
    return exit_code(diagnosis.diagnosis.verdict);
  }

  int add() const {
    Delivery delivery(wishes_, input_files(base_));
    const AircraftFit base = read_aircraft_fit(base_);
    const AircraftFit next = add_to_aircraft(base, read_flights(base), effect_);
    delivery.deliver(next);
    return exit_code(next.fit.status);
  }

  int apply() const {
    check_not_input(wishes_.output, base_);
    const AircraftFit base = read_aircraft_fit(base_);
    const Applied applied = apply_aircraft_to_file(
        base, flight_, wishes_.output, parse_deviations("--process-noise", process_noise_));
    tell_notes(applied.notes);
    give(wishes_.json, to_json(applied, base), to_text(applied, base));
    return 0;
  }

  int track() const {
    check_not_input(wishes_.output, base_);
    check_not_input(wishes_.output, flight_);
    FlightTrackOptions options = tracking_.resolve();
    options.how.process_noise = parse_deviations("--process-noise", process_noise_);
    options.how.initial_states = parse_deviations("--initial-state", initial_states_);
    OutputFile output(wishes_.output);
    const TrackedFlight tracked = track(options);
    tell_notes(tracked.notes);
    deliver_table(tracked, output);
    return 0;
  }

  TrackedFlight track(const FlightTrackOptions& options) const {
    if (const auto steps = read_two_step_fit(base_)) {
      return track_two_steps(*steps, read_flight(steps->path.options.calibration.log), options);
    }
    const AircraftFit base = read_aircraft_fit(base_);
    return track_aircraft(base, read_flight(base.options.calibration.log), options);
  }

  /// Writes a result that is a table, and prints what it says.
  template <class Result>
  void deliver_table(const Result& result, OutputFile& output) const {
    write_csv(result, output);
    output.commit();
    give(wishes_.json, to_json(result),
         to_text(result) + page("wrote {}\n", wishes_.output).text());
  }

  int response() const {
    check_not_input(wishes_.output, flight_);
    OutputFile output(wishes_.output);
    const LogChoice log = fit_arguments_.over({});
    const FlightResponse found = response_arguments_.find(read_flight(log), log);
    tell_notes(found.notes);
    deliver_table(found, output);
    return 0;
  }

  int design() const {
    if (base_.empty() != flight_.empty()) {
      throw Error("--for FIT.json and --flight FLIGHT.csv go together; give both, or none");
    }
    const InputDesign made = design_arguments_.design();
    if (base_.empty()) {
      OutputFile output(wishes_.output);
      deliver_table(made, output);
      return 0;
    }
    for (const std::string& file : {base_, flight_}) check_not_input(wishes_.output, file);
    OutputFile output(wishes_.output);
    const AircraftFit base = read_aircraft_fit(base_);
    const ExpectedFit expected =
        expect_aircraft(base, read_flight(base.options.calibration.log), made);
    write_csv(made, output);
    output.commit();
    give(wishes_.json, to_json(made, expected),
         to_text(made) + page("wrote {}\n", wishes_.output).text() +
             to_text(expected, detail_of(wishes_.explain)));
    return 0;
  }

  int simulate() const {
    if (!truth_.empty()) check_not_input(wishes_.output, truth_);
    OutputFile output(wishes_.output);
    const bool given = is_there(truth_);
    const SimulationOrder order = simulation_.resolve();
    AircraftTruth truth =
        parse_aircraft_truth(given ? files::read_text_file(truth_, "as a truth file") : "{}",
                             given ? truth_ : "simulate");
    truth.effects.insert(truth.effects.end(), order.hidden.begin(), order.hidden.end());
    const SimulatedFlight flight = simulate_aircraft(truth, order.options);
    const std::string flown = to_json(as_flown(truth, flight));
    const auto write = [](const std::string& file, const std::string& text) {
      OutputFile target(file);
      target.write(text);
      target.commit();
    };
    if (!truth_.empty() && !given) write(truth_, flown);
    if (!geometry_.empty()) write(geometry_, to_json(truth.geometry));
    write_csv(flight, output.stream());
    output.flush();
    output.commit();
    give(wishes_.json, flown, page("wrote {}: {} rows\n", wishes_.output, flight.rows()).text());
    return 0;
  }

  Delivery::Wishes wishes_;
  std::string flight_;
  std::vector<std::string> more_flights_;
  std::string base_;
  std::vector<std::string> references_;
  std::string effect_;
  std::string truth_;
  std::string geometry_;
  std::vector<std::string> process_noise_;
  std::vector<std::string> initial_states_;
  ModelArguments model_;
  TrackArguments tracking_;
  FitArguments fit_arguments_;
  SimulationArguments simulation_;
  ResponseArguments response_arguments_;
  DesignArguments design_arguments_;
  DiagnoseArguments diagnosis_;
  IntervalArguments profiles_;
  CLI::App& check_;
  CLI::App& fit_;
  CLI::App& two_step_;
  CLI::App& compare_;
  CLI::App& residuals_;
  CLI::App& intervals_;
  CLI::App& diagnose_;
  CLI::App& add_;
  CLI::App& apply_;
  CLI::App& track_;
  CLI::App& response_;
  CLI::App& design_;
  CLI::App& simulate_;
  CLI::App& effects_;
};

}  // namespace

int run_aircraft(const std::string& called, int argc, char** argv) {
  CLI::App cli(summary, called);
  const AircraftApp app(cli);
  return run(cli, argc, argv, [&] { return app.perform(); });
}

std::string aircraft_table() {
  CLI::App cli(summary, "sepcal aircraft");
  const AircraftApp app(cli);
  complete(cli);
  return table_of(cli, {"path", "aircraft"});
}

}  // namespace sepcal::app
