// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/aircraft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/thread_pool.hpp"
#include "estimation/check_options.hpp"
#include "flight/aircraft/aircraft_columns.hpp"
#include "flight/aircraft/aircraft_effects.hpp"
#include "flight/aircraft/believed_rows.hpp"
#include "flight/aircraft/innovation_comparison.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/aircraft/trajectory_effects.hpp"
#include "flight/files/flight_digest.hpp"
#include "flight/verbs/reference_comparison.hpp"
#include "flight/verbs/residual_comparison.hpp"
#include "sepcal/aircraft/two_step.hpp"
#include "sepcal/detail/flight/read_as.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own

namespace {

constexpr std::array<std::string_view, 5> model_names{"path", "longitudinal", "lateral", "six-dof",
                                                      "aero"};

/// Of another flight than the fitted one.
std::vector<OutputValue> rmse_on(const Flight& flight, const AircraftFit& fitted) {
  std::vector<OutputValue> rmse;
  for (const Misfit& misfit : compare_aircraft(fitted, flight).overall) {
    rmse.push_back({misfit.output, misfit.rmse});
  }
  return rmse;
}

/// With what the fit held among the options, so that they say all.
AircraftFit describe(const Flight& flight, AircraftOptions options, Fit fit) {
  for (const Parameter& parameter : fit.parameters) {
    if (parameter.fixed) options.calibration.fit.fix[parameter.name] = parameter.value;
  }
  if (options.model != AircraftModel::aero) options.calibration.fit.samples = 0;
  return {.options = std::move(options),
          .flight = FittedFlight{flight.name(), files::digest_of(flight), flight.rows(), fit.rows},
          .equations = {},
          .fit = std::move(fit)};
}

/// Throws Error for a band that can't be.
void check_domain(const AircraftOptions& options) {
  if (!options.band) return;
  check_band(*options.band);
  if (options.model == AircraftModel::path) {
    throw Error("a flight path is fitted in time; leave the band out, or choose another model");
  }
  if (options.calibration.fit.method == FitMethod::filter_error) {
    throw Error("filter error is of a fit in time; leave the band out, or the filter error");
  }
}

/// Biases and initial states, which a fit over a band has none of, found in time; all else is held.
Fit fit_rest_in_time(const AircraftFit& fitted, LaidAircraft& laid) {
  laid.notes.emplace_back("biases and initial states are found in time, all else is held");
  FitOptions options = laid.fit;
  options.coloured_errors = false;
  const std::vector<Variable> own = laid.model->tables().parameters();
  for (const Parameter& parameter : fitted.fit.parameters) {
    if (std::ranges::find(own, parameter.name, &Variable::name) == own.end()) continue;
    options.fix[parameter.name] = parameter.value;
    options.start.erase(parameter.name);
    options.prior.erase(parameter.name);
  }
  return fit(*laid.model, laid.record, options);
}

}  // namespace

std::string_view to_string(AircraftModel model) {
  return model_names[static_cast<std::size_t>(model)];
}

AircraftModel find_aircraft_model(std::string_view name) {
  const auto found = std::ranges::find(model_names, name);
  if (found == model_names.end()) {
    throw Error(
        fmt::format("there is no model '{}'; choose one of path, longitudinal, lateral, "
                    "six-dof, aero",
                    name));
  }
  return static_cast<AircraftModel>(found - model_names.begin());
}

std::string_view method_of(const AircraftFit& fitted) {
  if (fitted.options.band) {
    return fitted.options.model == AircraftModel::aero ? "frequency-equation-error"
                                                       : "frequency-output-error";
  }
  if (fitted.options.model == AircraftModel::aero) return "equation-error";
  return to_string(fitted.options.calibration.fit.method);
}

AeroEquation parse_equation(std::string_view text) {
  const std::size_t equals = text.find('=');
  AeroEquation equation{std::string(text.substr(0, equals)), {}};
  if (equals == std::string_view::npos || equals + 1 == text.size()) {
    throw Error(fmt::format("'{}' is no equation; write it as Cm=1,alpha,q_hat,elevator", text));
  }
  for (std::string_view rest = text.substr(equals + 1); !rest.empty();) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    equation.regressors.emplace_back(rest.substr(0, comma));
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  check_equations({equation});
  return equation;
}

AircraftFit fit_aircraft(const Flight& flight, const AircraftOptions& options) {
  estimation::refuse_sampling(options.calibration.fit, options.model == AircraftModel::aero
                                                           ? "coefficients are linear"
                                                           : "it begins at the flight's readings");
  if (options.model == AircraftModel::aero && !options.calibration.free.empty()) {
    throw OptionError(
        {Option{"free"}, ": equation error holds nothing that could be freed; leave it out"});
  }
  check_domain(options);
  LaidAircraft laid = lay(flight, options);
  AircraftFit fitted = describe(flight, options, fit_laid(laid, laid.fit));
  fitted.equations = std::move(laid.equations);
  fitted.options.calibration.effects = std::move(laid.effects);
  fitted.initial_states = std::move(laid.initial_states);
  fitted.notes = std::move(laid.notes);
  fitted.warning = std::move(laid.warning);
  return fitted;
}

TwoStepFit fit_two_steps(const Flight& flight, const AircraftOptions& options) {
  refuse_splines(options, "the two steps take products of powers alone");
  if (options.band) throw Error("two steps are fitted in time; leave the band out");
  if (options.calibration.log.smooth_inputs) {
    throw OptionError({Option{"smooth_inputs"},
                       " is of a fit; the path takes the noise out of what the second step reads"});
  }
  AircraftOptions second = options;
  second.model = AircraftModel::aero;
  second.calibration.free.clear();
  second.calibration.fit = {.coloured_errors = options.calibration.fit.coloured_errors,
                            .threads = options.calibration.fit.threads};
  AircraftOptions first = options;
  first.model = AircraftModel::path;
  first.calibration.effects.clear();
  ProbeRecord prepared = prepare(flight, two_step_columns(options), second.calibration.log);
  TwoStep steps = within(flight, [&] {
    return two_step(prepared.record, geometry_of(second),
                    {.equations = equations_of(second),
                     .path = options.trajectory,
                     .position = options.position,
                     .gravity = options.gravity,
                     .window = options.window,
                     .path_fit = options.calibration.fit,
                     .free = options.calibration.free,
                     .aero_fit = second.calibration.fit});
  });
  TwoStepFit found{.path = describe(flight, std::move(first), std::move(steps.path)),
                   .aero = describe(flight, std::move(second), std::move(steps.aero.fit)),
                   .notes = std::move(prepared.notes)};
  found.path.initial_states = std::move(steps.initial_states);
  found.aero.equations = std::move(steps.aero.equations);
  found.aero.warning = std::move(steps.aero.warning);
  found.notes.insert(found.notes.end(), steps.aero.notes.begin(), steps.aero.notes.end());
  return found;
}

double AddedRegressor::drop() const {
  double square = 0.0;
  for (std::size_t j = 0; j < rmse_after.size(); ++j) {
    square += std::pow(rmse_after[j].value / rmse_before[j].value, 2);
  }
  return 1.0 - std::sqrt(square / static_cast<double>(rmse_after.size()));
}

AircraftFit add_to_aircraft(const AircraftFit& base, const Flight& flight,
                            const std::string& effect) {
  std::vector<std::string> left_out;
  const AircraftFit fitted = without_suspects(base, flight, left_out);
  AircraftOptions options = options_on(fitted, flight);
  for (const std::string& one : split_effects(effect)) {
    options.calibration.effects.push_back({.name = one});
  }
  if (options.model != AircraftModel::aero) {
    options.calibration.fit.start = fitted.fit.nonlinear_estimates();
  }
  const bool same = is_same_flight(fitted, flight);
  for (const std::string& name : fitted.initial_states) {
    if (!same) options.calibration.fit.start.erase(name);
  }
  AircraftFit next = fit_aircraft(flight, options);
  next.notes.insert(next.notes.begin(), left_out.begin(), left_out.end());
  const Promise promised = promise_along(fitted, flight, next, effect);
  if (!promised.against.empty()) {
    next.notes.push_back(fmt::format("diagnose would not advise {}: {}", effect, promised.against));
  }
  next.history = fitted.history;
  next.history.push_back({effect, same ? fitted.fit.rmse : rmse_on(flight, fitted), next.fit.rmse,
                          promised.predicted_drop});
  return next;
}

Comparison compare_aircraft(const AircraftFit& fitted, const Flight& flight,
                            const std::vector<std::string>& references) {
  LaidAircraft laid = lay(flight, options_on(fitted, flight));
  base::ThreadPool pool(fitted.options.calibration.fit.threads);
  const Fit at = fit_on(flight, fitted, laid);
  const bool by_filter = at.method == FitMethod::filter_error;
  const FlightInnovations innovations =
      by_filter ? innovations_on(laid, at)
                : FlightInnovations{verbs::residuals_of(*laid.model, laid.record, at, pool), {}};
  Comparison result =
      verbs::compare_residuals(innovations.e, laid.model->tables(), laid.record,
                               channels_beside(laid, innovations.e), flight, fitted.fit, pool);
  if (by_filter) judge_by_filter(result, innovations, fitted, at, laid);
  result.model = to_string(fitted.options.model);
  if (!references.empty()) {
    std::vector<std::string> told_by_compare;
    result.references =
        verbs::compare_references(references, apply_aircraft(fitted, flight, {}, told_by_compare),
                                  {read_as(flight, fitted.options.calibration.log).flight, flight},
                                  {.record = laid.record, .flight_rows = laid.flight_rows});
  }
  result.notes = std::move(laid.notes);
  return result;
}

bool aircraft_log::is_same_flight(const AircraftFit& fitted, const Flight& flight) {
  return fitted.flight.sha256 == files::digest_of(flight);
}

AircraftOptions aircraft_log::options_on(const AircraftFit& fitted, const Flight& flight) {
  AircraftOptions options = fitted.options;
  if (is_same_flight(fitted, flight)) return options;
  for (const std::string& name : fitted.initial_states) {
    options.calibration.fit.start.erase(name);
    options.calibration.fit.fix.erase(name);
  }
  if (options.model != AircraftModel::aero && options.trajectory.outputs.empty()) {
    for (const OutputValue& output : fitted.fit.noise) {
      options.trajectory.outputs.push_back(output.name);  // whatever else this flight logs
    }
  }
  return options;
}

Fit aircraft_log::fit_on(const Flight& flight, const AircraftFit& fitted, LaidAircraft& laid) {
  if (fitted.options.band && fitted.options.model != AircraftModel::aero) {
    return fit_rest_in_time(fitted, laid);
  }
  if (is_same_flight(fitted, flight) || laid.initial_states.empty()) return fitted.fit;
  laid.notes.push_back(fmt::format(
      "{} is not the flight of the fit: its initial states are estimated anew, all else is held",
      flight.name()));
  FitOptions options = laid.fit;
  for (const Parameter& parameter : fitted.fit.parameters) {
    const auto& own = fitted.initial_states;
    if (std::ranges::find(own, parameter.name) == own.end()) {
      options.fix[parameter.name] = parameter.value;
    }
  }
  for (const auto& [name, value] : options.fix) {
    options.start.erase(name);
    options.prior.erase(name);
  }
  if (fitted.fit.method == FitMethod::filter_error) {
    options.process_noise = fitted.fit.process_noise();
    for (const OutputValue& noise : fitted.fit.noise) options.noise[noise.name] = noise.value;
  }
  return fit(*laid.model, readings_of(laid), options);
}

}  // namespace sepcal
