// SPDX-License-Identifier: BSD-3-Clause
// Every option of a fit on a flight, told once. JSON, Python's keyword arguments with their types
// and sentences, the command lines and their --help follow from this table. A new option is a
// member with its default (options.hpp, log_choice.hpp) and a row here.
#pragma once

#include <string_view>
#include <tuple>
#include <type_traits>

#include "sepcal/flight/calibration.hpp"

namespace sepcal::schema {

/// Where a calibration's file has an option.
enum class InFile { always, where_set, by_filter_error };

/// What is known of an option beside its member.
struct About {
  std::string_view sentence;    // what it says, without a full stop
  std::string_view unset = {};  // what holds where it is not given; empty: the member's default
  std::string_view flags = {};  // "--effect" of the programs; empty: code alone has it
  std::string_view form = {};   // what stands behind the flag: "NAME=LO,HI"
  InFile in_file = InFile::always;
};

template <class Part, class Value>
struct OptionField {
  std::string_view name;  // in code and in files
  Value Part::* member;
  About about;

  const Value& in(const CalibrationOptions& options) const { return part_of(options).*member; }
  Value& in(CalibrationOptions& options) const { return part_of(options).*member; }

  bool is_in_file(const CalibrationOptions& options) const {
    if (about.in_file == InFile::always) return true;
    if (about.in_file == InFile::by_filter_error) {
      return options.fit.method == FitMethod::filter_error;
    }
    if constexpr (std::is_same_v<Value, bool>) return in(options);
    if constexpr (requires { in(options).empty(); }) return !in(options).empty();
    if constexpr (requires { in(options).has_value(); }) return in(options).has_value();
    return true;
  }

  /// Whether it chooses of a flight's columns and rows.
  static constexpr bool is_of_log = std::is_same_v<Part, LogChoice>;

 private:
  template <class Options>
  static auto& part_of(Options& options) {
    if constexpr (std::is_same_v<Part, FitOptions>) {
      return options.fit;
    } else if constexpr (is_of_log) {
      return options.log;
    } else {
      return options;
    }
  }
};

template <class Part, class Value>
constexpr OptionField<Part, Value> option(std::string_view name, Value Part::* member,
                                          const About& about) {
  return {name, member, about};
}

/// In the order of files and of help.
inline constexpr std::tuple option_fields{
    option("effects", &CalibrationOptions::effects,
           {.sentence = "physical effects that join the model: port[driver], and those that "
                        "`effects` lists",
            .unset = "none",
            .flags = "--effect",
            .form = "EFFECT"}),
    option("stage_one_segments", &FitOptions::stage_one_segments,
           {.sentence = "maneuvers or times that stage one uses, e.g. wind_circle_1,510.9:530",
            .unset = "all",
            .flags = "--stage-one-segments",
            .form = "SEGMENTS"}),
    option("stage_two_segments", &FitOptions::stage_two_segments,
           {.sentence = "the same for stage two",
            .unset = "all",
            .flags = "--stage-two-segments",
            .form = "SEGMENTS"}),
    option("bounds", &FitOptions::bounds,
           {.sentence = "bounds of parameters, in their units; either may be left open, of a "
                        "nonlinear one with a "
                        "start",
            .unset = "the model's",
            .flags = "--bounds",
            .form = "NAME=LO,HI"}),
    option("start", &FitOptions::start,
           {.sentence = "where stage two starts, by nonlinear parameter; then nothing is sampled, "
                        "and those not named start from the middle of their bounds, or from zero "
                        "without",
            .unset = "sampling finds it",
            .flags = "--start",
            .form = "NAME=VALUE"}),
    option("fix", &FitOptions::fix,
           {.sentence = "parameters held at a value and not estimated",
            .unset = "none",
            .flags = "--fix",
            .form = "NAME=VALUE"}),
    option("free", &CalibrationOptions::free,
           {.sentence = "parameters freed that the probe holds by default",
            .unset = "none",
            .flags = "--free",
            .form = "NAME"}),
    option("noise", &FitOptions::noise,
           {.sentence = "noise standard deviation of every output, which is then held",
            .unset = "estimated, Eqs. 24-26",
            .flags = "--noise",
            .form = "OUTPUT=SD"}),
    option("prior", &FitOptions::prior,
           {.sentence = "a normal prior, mean and standard deviation: what is known of a parameter "
                        "beforehand, which counts as one more measurement of it",
            .unset = "none",
            .flags = "--prior",
            .form = "NAME=MEAN:SD"}),
    option("search", &FitOptions::search,
           {.sentence = "how stage one looks for minima: among samples, or by NLopt's global "
                        "search, which asks for the profile cost at most `samples` times",
            .flags = "--search",
            .form = "HOW"}),
    option("samples", &FitOptions::samples,
           {.sentence = "samples of the nonlinear parameters in stage one; 0: none",
            .flags = "--samples",
            .form = "N"}),
    option("sampling", &FitOptions::sampling,
           {.sentence = "how samples are spread: independent draws, or a shifted Halton sequence",
            .flags = "--sampling",
            .form = "HOW"}),
    option("sampling_distribution", &FitOptions::sampling_distribution,
           {.sentence = "mean and standard deviation of nonlinear parameters, whose samples are "
                        "then normal, cut at the bounds; it has no part in the fit itself",
            .unset = "uniform"}),
    option("screens", &FitOptions::screens,
           {.sentence = "evaluates Eqs. 17 and 18 at every sample, and uses only those with ratios "
                        "of at most t_1 and t_2 within l_2, and, with convex, positive second "
                        "derivatives: any of t_1, t_2, l_2, convex",
            .unset = "not evaluated",
            .in_file = InFile::where_set}),
    option("seed", &FitOptions::seed,
           {.sentence = "of the samples; the same seed gives the same result, on any number of "
                        "threads",
            .flags = "--seed",
            .form = "N"}),
    option("descents", &FitOptions::descents,
           {.sentence = "stage one descends from at most so many samples to tell minima apart"}),
    option("second_stage", &FitOptions::second_stage,
           {.sentence = "what stage two is over: all parameters, the nonlinear ones with the "
                        "linear ones solved inside, or as stage one finds a unique minimum or not "
                        "(Step 5); from a start the latter, and the former if it fails",
            .flags = "--second-stage",
            .form = "HOW"}),
    option("jacobian", &FitOptions::jacobian,
           {.sentence = "of a projected stage two: Kaufman's, or Golub and Pereyra's",
            .flags = "--jacobian",
            .form = "HOW"}),
    option("loss", &FitOptions::loss,
           {.sentence = "what a whitened residual costs; huber and cauchy forgive outliers and "
                        "make stage two joint",
            .flags = "--loss",
            .form = "HOW"}),
    option("loss_width", &FitOptions::loss_width,
           {.sentence = "where the loss begins to forgive, in standard deviations of the noise; "
                        "0: 1.345 for huber, 2.385 for cauchy",
            .flags = "--loss-width",
            .form = "K"}),
    option("noise_tolerance", &FitOptions::noise_tolerance,
           {.sentence = "R and the parameters alternate until every relative change of R is below "
                        "this, Eq. 26; the paper's is 0.05",
            .flags = "--noise-tolerance",
            .form = "T"}),
    option("noise_iterations", &FitOptions::noise_iterations,
           {.sentence = "at most so many alternations"}),
    option("iterations", &FitOptions::iterations,
           {.sentence = "at most so many of one nonlinear minimisation"}),
    option("coloured_errors", &FitOptions::coloured_errors,
           {.sentence = "standard errors allow for residuals that are not white; without, they "
                        "equal the white ones"}),
    option("method", &FitOptions::method,
           {.sentence = "of a model with a state: states are integrated; or noise drives them too, "
                        "and its size is estimated",
            .in_file = InFile::by_filter_error}),
    option("hessian", &FitOptions::hessian,
           {.sentence = "of filter error's standard errors and last steps: the expected one, or "
                        "the observed one where that is positive definite",
            .in_file = InFile::by_filter_error}),
    option("process_noise", &FitOptions::process_noise,
           {.sentence = "of a model with a state: noise that drives it, by the names of its table "
                        "`noise`, as roots of spectral densities in the table's unit (in discrete "
                        "time: standard deviations a row); by output error it has no part in the "
                        "fit, and standard errors allow for it; by filter error these are held",
            .unset = "none; of a path the white noise of the inertial unit's readings; by filter "
                     "error all are estimated",
            .in_file = InFile::where_set}),
    option("threads", &FitOptions::threads,
           {.sentence = "threads, the caller's included, on which the result does not depend; "
                        "0: one a core",
            .flags = "--threads",
            .form = "N"}),
    option("drop_invalid", &LogChoice::drop_invalid,
           {.sentence = "drops rows with a cell that is no number instead of refusing the flight",
            .flags = "--drop-invalid"}),
    option("drop_repeats", &LogChoice::drop_repeats,
           {.sentence = "drops the rows between the samples of slow columns that the log holds or "
                        "interpolates, e.g. airspeed; of several the slowest counts",
            .unset = "none",
            .flags = "--drop-repeats",
            .form = "COLUMN[,...]",
            .in_file = InFile::where_set}),
    option("map", &LogChoice::map,
           {.sentence = "reads the log's column under another header, e.g. airspeed_kt=TAS",
            .unset = "none",
            .flags = "--map",
            .form = "HEADER=COLUMN[,...]",
            .in_file = InFile::where_set}),
    option("ignore", &LogChoice::ignore,
           {.sentence = "as if these columns were not there",
            .unset = "none",
            .flags = "--ignore",
            .form = "COLUMN[,...]",
            .in_file = InFile::where_set}),
    option("where", &LogChoice::where,
           {.sentence = "takes only rows in which this holds, e.g. \"airspeed > 20 and "
                        "abs(roll_deg) < 45\"",
            .unset = "all",
            .flags = "--where",
            .form = "CONDITION",
            .in_file = InFile::where_set}),
    option("from_time", &LogChoice::from_time,
           {.sentence = "takes only rows from this time on [s]",
            .unset = "all",
            .flags = "--from,--from-time",
            .form = "S",
            .in_file = InFile::where_set}),
    option("to_time", &LogChoice::to_time,
           {.sentence = "takes only rows up to this time [s]",
            .unset = "all",
            .flags = "--to,--to-time",
            .form = "S",
            .in_file = InFile::where_set}),
    option("delimiter", &LogChoice::delimiter,
           {.sentence = "what parts the file's columns, where it can be read in two ways: ',', "
                        "';', '|', tab or space",
            .unset = "as the file shows",
            .flags = "--delimiter",
            .form = "MARK",
            .in_file = InFile::where_set}),
    option("decimal", &LogChoice::decimal,
           {.sentence = "the file's decimal mark, where it can be read in two ways: '.' or ','",
            .unset = "as the file shows",
            .flags = "--decimal",
            .form = "MARK",
            .in_file = InFile::where_set}),
    option("join", &LogChoice::join,
           {.sentence = "brings quantities that are logged at other times to the rows of the "
                        "measured one: smooth, linear or held",
            .unset = "they stand in one row",
            .flags = "--join",
            .form = "smooth|linear|held",
            .in_file = InFile::where_set}),
    option("smooth_inputs", &LogChoice::smooth_inputs,
           {.sentence = "takes the white noise out of the columns that the model reads as inputs, "
                        "which biases the estimates; the outputs stay as logged",
            .flags = "--smooth-inputs",
            .in_file = InFile::where_set}),
};

/// `visit` of each row.
template <class Visit>
constexpr void each_option(const Visit& visit) {
  std::apply([&](const auto&... fields) { (visit(fields), ...); }, option_fields);
}

}  // namespace sepcal::schema
