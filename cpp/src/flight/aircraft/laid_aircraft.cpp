// SPDX-License-Identifier: BSD-3-Clause
#include "flight/aircraft/laid_aircraft.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "base/columns.hpp"
#include "estimation/step_times.hpp"
#include "flight/aircraft/aircraft_columns.hpp"
#include "flight/aircraft/aircraft_effects.hpp"
#include "flight/aircraft/trajectory_effects.hpp"
#include "flight/verbs/input_noise.hpp"
#include "sepcal/aircraft/aero_model.hpp"
#include "sepcal/aircraft/output_error.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/aircraft/path.hpp"
#include "sepcal/error.hpp"
#include "sepcal/frequency/fit_in_band.hpp"
#include "sepcal/frequency/output_error_in_band.hpp"
#include "sepcal/states/stream_start.hpp"
#include "states/composed_trajectory.hpp"

namespace sepcal::aircraft_log {
namespace {

std::vector<std::string> coefficients_of(const AircraftOptions& options) {
  switch (options.model) {
    case AircraftModel::longitudinal:
      return {"CX", "CZ", "Cm"};
    case AircraftModel::lateral:
      return {"CY", "Cl", "Cn"};
    default:
      return {};
  }
}

AircraftAxes axes_of(AircraftModel model) {
  if (model == AircraftModel::longitudinal) return AircraftAxes::longitudinal;
  return model == AircraftModel::lateral ? AircraftAxes::lateral : AircraftAxes::six_dof;
}

/// Writes settings back to where they stand among all.
void put_back(const std::vector<EffectSetting>& settings, const AircraftOptions& options,
              std::vector<EffectSetting>& all) {
  auto next = settings.begin();
  for (EffectSetting& effect : all) {
    if (acts_along(options.model, effect.name)) effect = *next++;
  }
}

void lay_along_path(const AircraftOptions& options, LaidAircraft& laid) {
  const Eigen::Vector3d vane = options.geometry
                                   ? Eigen::Vector3d(options.geometry->vane - options.geometry->imu)
                                   : Eigen::Vector3d::Zero();
  PathTrajectory path = lay_path(laid.record, {.trajectory = options.trajectory,
                                               .position = options.position,
                                               .gravity = options.gravity,
                                               .vane = vane,
                                               .free = options.calibration.free,
                                               .fit = options.calibration.fit});
  laid.path = path.model;
  laid.model = std::move(path.model);
  laid.record = std::move(path.record);
  laid.fit = std::move(path.fit);
  laid.initial_states = std::move(path.initial_states);
  if (laid.fit.method == FitMethod::filter_error) {
    laid.warning = "filter error takes the inertial unit's errors for white noise, not for drift";
    return;
  }
  const bool told = laid.fit.process_noise.empty();
  if (told) laid.fit.process_noise = noise_of_readings(laid.record);
  laid.warning = fmt::format(
      "intervals allow for {} of the inertial unit, not for its drift; cut long segments (shoot)",
      told ? "the white noise" : "the process noise that was given");
}

void lay_coefficients(const AircraftOptions& options, LaidAircraft& laid) {
  std::vector<std::string> names;
  for (const AeroEquation& equation : laid.equations) names.push_back(equation.coefficient);
  AeroCoefficients found = aero_coefficients(laid.record, geometry_of(options),
                                             {.coefficients = names, .window = options.window});
  laid.record = std::move(found.record);
  laid.window = found.window;
  const auto model = std::make_shared<AeroModel>(laid.equations);
  std::vector<EffectSetting> splines = splines_of(laid.effects);
  const EffectKit kit = coefficient_kit(laid.equations);
  laid.model = compose(model, make_effects(kit, *model, splines, laid.record), laid.record);
  laid.effects = with_knots(std::move(laid.effects), splines);
  laid.notes.insert(laid.notes.end(), found.notes.begin(), found.notes.end());
  laid.warning = regressor_warning;
}

void lay_motion(const AircraftOptions& options, LaidAircraft& laid) {
  AircraftTrajectory along = lay_aircraft(laid.record, geometry_of(options),
                                          {.axes = axes_of(options.model),
                                           .equations = laid.equations,
                                           .trajectory = options.trajectory,
                                           .free = options.calibration.free,
                                           .gravity = options.gravity,
                                           .window = options.window,
                                           .fit = options.calibration.fit});
  laid.model = std::move(along.model);
  laid.record = std::move(along.record);
  laid.fit = std::move(along.fit);
  laid.notes.insert(laid.notes.end(), along.notes.begin(), along.notes.end());
  laid.warning = std::move(along.warning);
  laid.initial_states = std::move(along.initial_states);
}

/// Effects along the trajectory join the model; what they correct begins at zero.
void join_effects(const AircraftOptions& options, LaidAircraft& laid) {
  laid.base = laid.model;
  std::vector<EffectSetting> settings = effects_along(options, laid.effects);
  if (settings.empty()) return;
  EffectKit kit = trajectory_kit(options.model, laid.base->tables());
  std::vector<std::string> splines;
  for (const EffectSetting& spline : splines_of(settings)) splines.push_back(spline.name);
  add_regressors(splines, kit);
  laid.along = make_effects(kit, *laid.base, settings, laid.record);
  laid.model = compose(laid.base, laid.along, laid.record);
  laid.fit.unsampled.merge(initial_corrections(laid.along));
  for (const Variable& parameter : laid.model->tables().nonlinear) {  // of splines
    const bool is_new = std::ranges::find(laid.base->tables().nonlinear, parameter.name,
                                          &Variable::name) == laid.base->tables().nonlinear.end();
    if (is_new) laid.fit.unsampled.try_emplace(parameter.name, 0.0);
  }
  put_back(settings, options, laid.effects);
}

/// What does nothing at the operating point, or the same as another there: constants and products.
bool bends(const std::string& regressor) {
  const std::vector<ChannelFactor>& factors = Regressor(regressor).factors();
  return factors.size() != 1 || factors.front().power != 1 || factors.front().absolute;
}

/// Over a band the aircraft is linear: such regressors stay where equation error had them.
void hold_bent(const AircraftOptions& options, LaidAircraft& laid) {
  if (!laid.along.empty()) {
    throw Error(
        fmt::format("an aircraft with '{}' is fitted in time; leave the effect or the band "
                    "out",
                    effects_along(options, laid.effects).front().name));
  }
  std::vector<std::string> held;
  for (const AeroEquation& equation : laid.equations) {
    for (const std::string& regressor : equation.regressors) {
      const std::string name = parameter_name(equation.coefficient, regressor);
      const auto start = laid.fit.start.find(name);
      if (!bends(regressor) || start == laid.fit.start.end()) continue;
      if (laid.fit.fix.emplace(name, start->second).second) held.push_back(name);
    }
  }
  for (const std::string& name : held) laid.fit.start.erase(name);
  if (held.empty()) return;
  laid.notes.push_back(fmt::format(
      "about the flight's means the aircraft is linear: {} are held where equation error has them",
      fmt::join(held, ", ")));
}

Fit fit_over_band(LaidAircraft& laid, const Band& band, const FitOptions& options) {
  const auto* with_state = dynamic_cast<const StateBlockModel*>(laid.model.get());
  if (with_state == nullptr) return fit_in_band(*laid.model, laid.record, band, options);
  Fit found = fit_output_error_in_band(*with_state, laid.record, band, options);
  laid.initial_states.clear();
  for (int k = 0; k < found.n_1; ++k) {
    laid.initial_states.push_back(found.parameters[static_cast<std::size_t>(k)].name);
  }
  return found;
}

/// By filter error with the gaps of outputs, of which another fit is told where they stop it.
ProbeRecord prepare_for(const Flight& flight, const AircraftOptions& options, LaidAircraft& laid) {
  const LogChoice& log = options.calibration.log;
  const AskedColumns asked{.model = options.model,
                           .symmetric = is_symmetric(options.model, laid.equations),
                           .position = options.position};
  const bool has_state = options.model != AircraftModel::aero && !options.band;
  if (has_state && options.calibration.fit.method == FitMethod::filter_error) {
    return prepare(flight, asked, log, &laid.gaps);
  }
  try {
    return prepare(flight, asked, log);
  } catch (const Error& error) {
    if (!has_state || !has_gaps(flight, asked, log)) throw;
    throw_within("", error, "; filter error takes the readings that are there");
  }
}

/// What options say by themselves.
LaidAircraft begin(const AircraftOptions& options) {
  if (options.model == AircraftModel::path && !options.equations.empty()) {
    throw Error("a flight path has no equations; leave them out, or fit a model of the aircraft");
  }
  LaidAircraft laid;
  laid.effects = options.calibration.effects;
  laid.band = options.band;
  laid.equations = equations_of(options);
  laid.fit = options.calibration.fit;
  return laid;
}

/// The model along the record that `laid` has; `flight` is what messages call it.
void lay_along_record(const std::string& flight, const AircraftOptions& options,
                      LaidAircraft& laid) {
  const auto smooth_inputs = [&] {
    if (!options.calibration.log.smooth_inputs) return;
    verbs::take_out_input_noise(laid.model->tables(), flight, laid.record, laid.notes);
  };
  if (options.model == AircraftModel::path) {
    lay_along_path(options, laid);
    smooth_inputs();
    join_effects(options, laid);
  } else if (options.model == AircraftModel::aero) {
    lay_coefficients(options, laid);
    smooth_inputs();
  } else {
    lay_motion(options, laid);
    smooth_inputs();
    join_effects(options, laid);
    if (laid.band) hold_bent(options, laid);
  }
}

/// Of the whole flight, or of its first rows.
LaidAircraft lay_rows(const Flight& flight, const AircraftOptions& options,
                      std::optional<std::size_t> rows) {
  LaidAircraft laid = begin(options);
  ProbeRecord prepared = prepare_for(flight, options, laid);
  laid.record = rows ? first_rows(prepared.record, *rows) : std::move(prepared.record);
  laid.notes = std::move(prepared.notes);
  laid.flight_rows = std::move(prepared.flight_rows);
  within(flight, [&] { lay_along_record(flight.name(), options, laid); });
  std::erase_if(laid.gaps, [&](const GappedOutput& one) {
    const std::vector<Variable>& outputs = laid.model->tables().outputs;
    return std::ranges::find(outputs, one.name, &Variable::name) == outputs.end();
  });
  for (GappedOutput& one : laid.gaps) one.values.resize(laid.record.length());  // of first rows
  return laid;
}

}  // namespace

const AircraftGeometry& geometry_of(const AircraftOptions& options) {
  if (options.geometry) return *options.geometry;
  throw Error(fmt::format(
      "the model '{}' needs the aircraft's dimensions and mass: give --geometry AIRCRAFT.json "
      "(area_m2, chord_m, span_m, mass_kg, inertia_kgm2 [Ix, Iy, Iz, Ixz])",
      to_string(options.model)));
}

std::vector<AeroEquation> equations_of(const AircraftOptions& options) {
  if (options.model == AircraftModel::path) return {};
  std::vector<AeroEquation> equations =
      options.model == AircraftModel::aero && !options.equations.empty()
          ? options.equations
          : complete_equations(options.equations, coefficients_of(options));
  return with_regressors(std::move(equations), options);
}

void need_rows_in_time(const AircraftFit& fitted, std::string_view what_it_needs) {
  if (!fitted.options.band) return;
  throw Error(
      fmt::format("a fit over a band {}; fit the same equations in time for that, without "
                  "the band",
                  what_it_needs));
}

std::vector<EffectSetting> effects_along(const AircraftOptions& options,
                                         const std::vector<EffectSetting>& effects) {
  std::vector<EffectSetting> along;
  std::ranges::copy_if(effects, std::back_inserter(along), [&](const EffectSetting& effect) {
    return acts_along(options.model, effect.name);
  });
  return along;
}

Fit fit_laid(LaidAircraft& laid, const FitOptions& options) {
  if (laid.band) return fit_over_band(laid, *laid.band, options);
  const Record readings = readings_of(laid);
  if (laid.along.empty()) return fit(*laid.model, readings, options);
  return estimation::fit_with_steps(*laid.model, *laid.base, laid.along, laid.effects, readings,
                                    options);
}

Record readings_of(const LaidAircraft& laid) {
  if (laid.gaps.empty()) return laid.record;
  base::Columns columns(laid.record);
  for (const GappedOutput& one : laid.gaps) columns.set(one.name, one.values);
  return columns.record();
}

void need_every_reading(const LaidAircraft& laid, std::string_view verb) {
  if (laid.gaps.empty()) return;
  throw Error(
      fmt::format("{} takes a reading of every output in every row, and {} has gaps; leave it out "
                  "of the fit (--outputs), or fit with --drop-invalid",
                  verb, laid.gaps.front().name));
}

Record seen_by_model(const LaidAircraft& laid, const Fit& fit) {
  const auto* with = dynamic_cast<const states::ComposedTrajectory*>(laid.model.get());
  if (with == nullptr) return laid.record;
  return with->correct(laid.record, values_of(fit.xi2()));
}

Record channels_beside(const LaidAircraft& laid, const Eigen::MatrixXd& residuals) {
  if (dynamic_cast<const StateBlockModel*>(laid.model.get()) == nullptr) return laid.record;
  const std::vector<Variable>& outputs = laid.model->tables().outputs;
  Record modelled;  // what states are made of
  for (const char* name : {"airspeed", "alpha", "beta", "roll", "pitch", "yaw"}) {
    if (!laid.record.has(name)) continue;
    const auto read = laid.record.column(name);
    std::vector<double> values(read.begin(), read.end());
    const auto output = std::ranges::find(outputs, name, &Variable::name);
    if (output != outputs.end()) {
      Eigen::Index k = 0;
      for (const Segment& segment : laid.record.segments()) {
        for (std::size_t row = segment.first; row < segment.last; ++row, ++k) {
          values[row] -= residuals(k, output - outputs.begin());
        }
      }
    }
    modelled.add(name, std::move(values));
  }
  const Record states = with_states(modelled);
  base::Columns columns(laid.record);
  for (const char* name : {"u", "v", "w", "phi", "theta", "psi"}) {
    if (!laid.record.has(name) || !states.has(name)) continue;
    const auto values = states.column(name);
    columns.set(name, {values.begin(), values.end()});
  }
  return columns.record();
}

LaidAircraft lay(const Flight& flight, const AircraftOptions& options) {
  return lay_rows(flight, options, std::nullopt);
}

LaidAircraft lay_first_rows(const Flight& flight, const AircraftOptions& options,
                            std::size_t rows) {
  return lay_rows(flight, options, rows);
}

LaidAircraft lay_record(Record record, const AircraftOptions& options) {
  LaidAircraft laid = begin(options);
  laid.record = std::move(record);
  lay_along_record("the record", options, laid);
  return laid;
}

const StateBlockModel& state_model_of(const LaidAircraft& laid, const AircraftFit& fitted) {
  const auto* model = dynamic_cast<const StateBlockModel*>(laid.model.get());
  if (model != nullptr) return *model;
  throw Error(
      fmt::format("the model '{}' has no state to smooth; fit path, longitudinal, lateral "
                  "or six-dof for that",
                  to_string(fitted.options.model)));
}

}  // namespace sepcal::aircraft_log
