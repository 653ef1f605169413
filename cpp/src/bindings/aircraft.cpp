// SPDX-License-Identifier: BSD-3-Clause
// Aircraft from flights: flights, fits and comparisons of sepcal._core come in and go out.
#include "sepcal/flight/aircraft.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <tuple>

#include "arrays.hpp"
#include "bindings.hpp"
#include "released.hpp"
#include "residual_columns.hpp"
#include "results.hpp"
#include "sepcal/detail/aircraft/coefficients.hpp"
#include "sepcal/detail/flight/aircraft_file.hpp"
#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/detail/simulation/truth.hpp"
#include "sepcal/flight/expected_fit.hpp"
#include "sepcal/simulation/aircraft.hpp"
#include "simulated.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;
using Equations = std::map<std::string, std::vector<std::string>>;

/// `band` is low, high, spacing [Hz]; `geometry` is an aircraft as JSON; equations are
/// {coefficient: [regressors]}.
AircraftOptions aircraft_options(const std::string& model,
                                 const std::optional<std::string>& geometry,
                                 const Equations& equations, const TrajectoryOptions& trajectory,
                                 bool position, double gravity, double window,
                                 const std::optional<std::array<double, 3>>& band,
                                 const CalibrationOptions& fit) {
  AircraftOptions options{.model = find_aircraft_model(model),
                          .geometry = {},
                          .equations = {},
                          .trajectory = trajectory,
                          .position = position,
                          .gravity = gravity,
                          .window = window,
                          .band = {},
                          .calibration = fit};
  if (geometry) options.geometry = parse_aircraft(*geometry, "the aircraft");
  if (band) options.band = Band{(*band)[0], (*band)[1], (*band)[2]};
  for (const auto& [coefficient, regressors] : equations) {
    options.equations.push_back({coefficient, regressors});
  }
  return options;
}

/// As its app's page shows it.
FittedModel fit_of(const AircraftFit& fitted) {
  return fitted_model(fitted.fit, fitted.options.calibration.effects, page_of(fitted));
}

Equations equations_of(const AircraftFit& fitted) {
  Equations equations;
  for (const AeroEquation& equation : fitted.equations) {
    equations[equation.coefficient] = equation.regressors;
  }
  return equations;
}

using Values = std::map<std::string, double>;

Values by_output(const std::vector<OutputValue>& values) {
  Values named;
  for (const OutputValue& value : values) named[value.name] = value.value;
  return named;
}

/// [(effect, {output: rmse before}, {output: rmse after}), ...]
using Added = std::tuple<std::string, Values, Values, double, double>;

std::vector<Added> history_of(const AircraftFit& fitted) {
  std::vector<Added> history;
  for (const AddedRegressor& added : fitted.history) {
    history.emplace_back(added.effect, by_output(added.rmse_before), by_output(added.rmse_after),
                         added.predicted_drop, added.drop());
  }
  return history;
}

/// ({header: values}, notes)
using AppliedColumns = std::pair<py::typing::Dict<py::str, Array>, std::vector<std::string>>;

AppliedColumns apply_to(const AircraftFit& fitted, const Flight& flight,
                        const ProcessNoise& process_noise) {
  std::vector<std::string> notes;
  const auto run = [&] {
    const Released released;
    return apply_aircraft(fitted, flight, process_noise, notes);
  };
  py::typing::Dict<py::str, Array> columns;
  for (CorrectedColumn& column : run()) {
    columns[py::str(column.header)] = adopt(std::move(column.values));
  }
  return {columns, notes};
}

FittedModel expect_on(const AircraftFit& fitted, const Flight& flight, const Flight& inputs) {
  const Released released;
  ExpectedFit expected = expect_aircraft(fitted, flight, inputs);
  Page page = page_of(expected);
  return fitted_model(std::move(expected.fit), {}, std::move(page));
}

Tracking track_on(const AircraftFit& fitted, const Flight& flight,
                  const FlightTrackOptions& options) {
  const Released released;
  return tracking(track_aircraft(fitted, flight, options));
}

/// What the app's two-step prints.
struct FittedSteps {
  AircraftFit path;
  AircraftFit aero;
  std::vector<std::string> notes;
  std::string json;
  Page page;
};

Tracking track_steps(const FittedSteps& fitted, const Flight& flight,
                     const FlightTrackOptions& options) {
  const Released released;
  return tracking(track_two_steps({.path = fitted.path, .aero = fitted.aero}, flight, options));
}

DiagnosisOptions with_threads_of(const AircraftFit& fitted, const DiagnosisOptions& asked) {
  return with_threads(asked, fitted.options.calibration.fit.threads);
}

ResidualColumns residuals_on(const AircraftFit& fitted, const Flight& flight) {
  ResidualTable table;
  {
    const Released released;
    table = tabulate_residuals(compare_aircraft(fitted, flight), flight,
                               fitted.options.calibration.log, fitted.fit.noise);
  }
  return residual_columns(std::move(table));
}

Diagnosed diagnose_on(const AircraftFit& fitted, const Flight& flight, const Injected& injected,
                      const DiagnosisOptions& asked) {
  const Released released;
  const DiagnosisOptions options = with_threads_of(fitted, asked);
  return diagnosed(injected ? diagnose_aircraft_with({injected->first, injected->second}, fitted,
                                                     flight, options)
                            : diagnose_aircraft(fitted, flight, options));
}

FoundIntervals intervals_on(const AircraftFit& fitted, const Flight& flight, double level,
                            const std::vector<std::string>& names) {
  const Released released;
  return found_intervals(find_aircraft_intervals(fitted, flight, {.level = level, .names = names}));
}

Checked check_on(const std::string& model, const Flight& flight,
                 const CalibrationOptions& options) {
  const Released released;
  return checked(check_aircraft(find_aircraft_model(model), flight, options.log));
}

/// As a fit with these options reads them; in the order of one that there is.
Flight join(const std::vector<Flight>& flights, const CalibrationOptions& options,
            const std::optional<AircraftFit>& fitted) {
  const Released released;
  std::vector<std::string> notes;
  return join_aircraft_flights(flights, fitted ? fitted->options.calibration.log : options.log,
                               notes, fitted ? &*fitted : nullptr);
}

Stepped<AircraftFit> diagnose_stepwise_on(const AircraftFit& fitted, const Flight& flight,
                                          std::optional<std::size_t> most,
                                          const DiagnosisOptions& asked) {
  const Released released;
  StepwiseAircraft result = diagnose_aircraft_stepwise(
      fitted, flight, stepwise_options(most, with_threads_of(fitted, asked)));
  std::string json = to_json(result);
  Page page = page_of(result);
  return stepped(std::move(result.fitted), std::move(result.course), std::move(json),
                 std::move(page));
}

/// {column: values}, the coefficients' names, the window [s], notes.
std::tuple<py::typing::Dict<py::str, Array>, std::vector<std::string>, double,
           std::vector<std::string>>
coefficients_of(const py::dict& columns, const std::vector<std::string>& labels,
                const std::string& geometry, const std::vector<std::string>& coefficients,
                double window) {
  const Record record = record_of(columns, labels);
  AeroCoefficients found = [&] {
    const Released released;
    return aero_coefficients(record, parse_aircraft(geometry, "the aircraft"),
                             {.coefficients = coefficients, .window = window});
  }();
  py::typing::Dict<py::str, Array> result;
  for (const std::string& name : found.record.names()) {
    const std::span<const double> values = found.record.column(name);
    result[py::str(name)] = adopt({values.begin(), values.end()});
  }
  return {result, std::move(found.names), found.window, std::move(found.notes)};
}

void save(const AircraftFit& fitted, const std::string& file) {
  OutputFile output(file);
  output.write(to_json(fitted));
  output.commit();
}

FittedSteps two_steps(const Flight& flight, const AircraftOptions& options) {
  TwoStepFit fitted = fit_two_steps(flight, options);
  std::string json = to_json(fitted);
  Page page = page_of(fitted);
  return {std::move(fitted.path), std::move(fitted.aero), std::move(fitted.notes), std::move(json),
          std::move(page)};
}

Simulated simulate(const std::string& truth, const Hidden& hidden, const std::string& excitation,
                   const std::string& noise, std::size_t decoys, double rate, std::size_t rows,
                   std::uint64_t seed) {
  const Released released;
  return simulated(
      simulate_aircraft(with_hidden(parse_aircraft_truth(truth, "simulate"), hidden),
                        simulation_options(excitation, noise, decoys, rate, rows, seed)));
}

void define_fits(py::module_& module) {
  py::class_<AircraftFit> fitted(module, "Fit");
  define_stepped<AircraftFit>(module, "SteppedFit");
  fitted.def_property_readonly("fit", &fit_of)
      .def_property_readonly("model",
                             [](const AircraftFit& self) { return to_string(self.options.model); })
      .def_property_readonly("method", [](const AircraftFit& self) { return method_of(self); })
      .def_property_readonly("equations", &equations_of)
      .def_property_readonly("history", &history_of)
      .def_readonly("initial_states", &AircraftFit::initial_states)
      .def_readonly("notes", &AircraftFit::notes)
      .def_readonly("warning", &AircraftFit::warning)
      .def_property_readonly("file", [](const AircraftFit& self) { return self.flight.file; })
      .def(
          "compare",
          [](const AircraftFit& self, const Flight& flight,
             const std::vector<std::string>& references) {
            return compared(compare_aircraft(self, flight, references));
          },
          "flight"_a, "references"_a = std::vector<std::string>(), WithoutGil())
      .def("residuals", &residuals_on)
      .def("diagnose", &diagnose_on)
      .def("intervals", &intervals_on)
      .def("expect", &expect_on)
      .def("diagnose_stepwise", &diagnose_stepwise_on)
      .def("add", &add_to_aircraft, WithoutGil())
      .def("apply", &apply_to)
      .def("apply_to_file",
           [](const AircraftFit& self, const std::string& file, const std::string& output,
              const ProcessNoise& process_noise) {
             const Released released;
             return apply_aircraft_to_file(self, file, output, process_noise);
           })
      .def("smooth", &smooth_aircraft, WithoutGil())
      .def("track", &track_on)
      .def("to_json", [](const AircraftFit& self) { return to_json(self); })
      .def("save", &save, WithoutGil());
  py::class_<FittedSteps>(module, "Steps")
      .def_readonly("path", &FittedSteps::path)
      .def_readonly("aero", &FittedSteps::aero)
      .def_readonly("notes", &FittedSteps::notes)
      .def_readonly("json", &FittedSteps::json)
      .def("track", &track_steps)
      .def_property_readonly("text", [](const FittedSteps& self) { return self.page.text; })
      .def_property_readonly("explained",
                             [](const FittedSteps& self) { return self.page.explained; });
}

}  // namespace

void define_aircraft(py::module_& module) {
  py::class_<AircraftOptions>(module, "Options")
      .def(py::init(&aircraft_options), py::kw_only(), "model"_a, "geometry"_a, "equations"_a,
           "trajectory"_a, "position"_a = false, "gravity"_a, "window"_a, "band"_a, "fit"_a);
  define_fits(module);
  module.def("fit", &fit_aircraft, WithoutGil());
  module.def("two_steps", &two_steps, WithoutGil());
  module.def("check", &check_on);
  module.def("join", &join);
  module.def("parse", &parse_aircraft_fit);
  module.def("read", &read_aircraft_fit);
  module.def("read_aircraft", [](const std::string& file) { return to_json(read_aircraft(file)); });
  module.def("aero_coefficients", &coefficients_of);
  module.def("simulate", &simulate);
  module.def("standard_regressors", [](const std::string& coefficient) {
    return standard_equations({coefficient}).front().regressors;
  });
}

}  // namespace sepcal::bindings
