// SPDX-License-Identifier: BSD-3-Clause
// What drives a hidden effect: the word in its brackets, read and turned into a function of the
// moment. Private to the simulators, which share no code with the effects that a fit knows.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal::simulation {

/// The world at one time, as far as something can be driven by it.
struct Moment {
  double time = 0.0;           // [s]
  std::vector<double> values;  // in the order of Sources::names
};

/// What a simulated log offers to drive an effect.
struct Sources {
  std::vector<std::string> names;                 // "time" first, then columns and p, q, r
  std::function<Moment(double)> at;               // any time [s], not only a row's
  std::function<std::string_view(double)> label;  // the maneuver at a time [s]
  std::vector<Moment> rows;                       // at every row of the log
  std::vector<std::string> labels;                // in order of appearance
};

/// With the moments and the labels of rows at `times`.
Sources list_sources(std::vector<std::string> names, std::function<Moment(double)> at,
                     std::function<std::string_view(double)> label,
                     const std::vector<double>& times);

struct Driver {
  enum class Form { constant, power, exponent, spline, maneuver, step, ramp, decay, delay };

  Form form = Form::constant;
  std::size_t base = 0;  // index in Sources::names
  int number = 1;        // the power, or how many knots
};

/// The driver that `text` names, "" for a constant. Throws Error, opened by `effect`, for another
/// form than the known ones and for a base that `sources` doesn't have.
Driver parse_driver(const std::string& effect, std::string_view text, const Sources& sources);

/// Throws Error, opened by `effect`, for a shift in time [s] further than the motion reaches beyond
/// the record's ends; else gives it back.
double check_shift(const std::string& effect, double shift);

/// "t0", "tau", "exponent", or "" where the driver has no shape of its own.
std::string_view shape_parameter(Driver::Form form);

/// The shape where none is given [s or 1].
double default_shape(Driver::Form form, const Sources& sources);

/// What tells the coefficients of one component apart: {""}, or {"_2", "_3", ...} of a spline's
/// knots or of labels. Throws Error, opened by `effect`, where a flight has one maneuver only.
std::vector<std::string> coefficient_suffixes(const std::string& effect, const Driver& driver,
                                              const Sources& sources);

/// The driver's function with its coefficients, one a suffix. Throws Error, opened by `effect`, for
/// a shape out of range and for a spline over a constant.
std::function<double(const Moment&)> drive(const std::string& effect, const Driver& driver,
                                           const Sources& sources,
                                           std::span<const double> coefficients, double shape);

}  // namespace sepcal::simulation
