// SPDX-License-Identifier: BSD-3-Clause
// Models with a state: sepcal's own and those written in Python.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "flight/verbs/held_options.hpp"
#include "python_state_model.hpp"
#include "released.hpp"
#include "results.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/own_state_model.hpp"
#include "sepcal/flight/track.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/states/smooth_record.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;

/// As a user sees it along a record: shoot cuts nothing where there is none.
TrajectoryOptions options_for(const Record* record, TrajectoryOptions options) {
  if (record == nullptr) options.shoot = infinity;
  return options;
}

template <StateModel M>
Model lay(const M& model, const TrajectoryOptions& options) {
  return Model([=](const Record* record) -> std::shared_ptr<const BlockModel> {
    if (record == nullptr) {
      return std::make_shared<const TrajectoryModel<M>>(model, options_for(record, options));
    }
    return std::make_shared<const TrajectoryModel<M>>(model, *record, options);
  });
}

using Vector = std::array<double, 3>;

template <bool Position>
Model lay_flight_path(double gravity, const Vector& vane, const TrajectoryOptions& options) {
  const FlightPathModel<Position> model{.gravity = gravity, .vane = {vane[0], vane[1], vane[2]}};
  Model laid = lay(model, options);
  for (const std::string_view name : model.held_at_zero) laid.held[std::string(name)] = 0.0;
  return laid;
}

Model flight_path(bool position, double gravity, const Vector& vane,
                  const TrajectoryOptions& options) {
  return position ? lay_flight_path<true>(gravity, vane, options)
                  : lay_flight_path<false>(gravity, vane, options);
}

InputsBetweenRows inputs_between_rows(const std::string& word) {
  for (const auto known : {InputsBetweenRows::linear, InputsBetweenRows::hold}) {
    if (word == to_string(known)) return known;
  }
  throw Error("inputs is '" + word + "'; between rows they are 'linear', or 'hold'");
}

TrajectoryOptions trajectory_options(const std::string& inputs, int substeps, double shoot,
                                     std::vector<std::string> measured,
                                     std::vector<std::string> outputs, bool separable,
                                     bool scales_about_start) {
  return {.inputs = inputs_between_rows(inputs),
          .substeps = substeps,
          .shoot = shoot,
          .measured = std::move(measured),
          .outputs = std::move(outputs),
          .separable = separable,
          .scales_about_start = scales_about_start};
}

using Row = std::tuple<std::string, std::string, double, double>;  // name, unit, lower, upper

std::vector<Variable> to_variables(const std::vector<Row>& rows) {
  std::vector<Variable> table;
  for (const auto& [name, unit, lower, upper] : rows) table.emplace_back(name, unit, lower, upper);
  return table;
}

/// inputs, states, outputs, linear, nonlinear, noise; the rest as StateTables has it.
StateTables state_tables(const std::array<std::vector<Row>, 6>& tables,
                         std::vector<int> linear_dynamic, bool linear_in_state,
                         std::vector<bool> scales, std::vector<std::vector<bool>> acts_on,
                         bool discrete) {
  return {.inputs = to_variables(tables[0]),
          .states = to_variables(tables[1]),
          .outputs = to_variables(tables[2]),
          .linear = to_variables(tables[3]),
          .nonlinear = to_variables(tables[4]),
          .linear_dynamic = std::move(linear_dynamic),
          .linear_in_state = linear_in_state,
          .scales = std::move(scales),
          .acts_on = std::move(acts_on),
          .noise = to_variables(tables[5]),
          .discrete = discrete};
}

Model python_state_model(const std::string& name, const StateTables& tables,
                         const TrajectoryOptions& options, const py::object& walk,
                         const Source& source) {
  const std::shared_ptr<const py::object> kept = share(walk);
  const auto lay = [=](const Record* record) {
    return std::make_shared<const PythonStateModel>(
        TrajectoryPlan(tables, record, options_for(record, options)), kept);
  };
  Model model{Along(lay)};
  model.own = own_if_free(
      name, LaidAlong([=](const Record* record) { return laid_model(lay(record), options); }),
      {source.first, source.second});
  return model;
}

SmoothedRecord smooth_columns(const Model& model, const py::dict& columns,
                              const std::vector<std::string>& labels,
                              const std::map<std::string, double>& parameters,
                              const std::map<std::string, double>& process,
                              const std::map<std::string, double>& outputs,
                              const std::map<std::string, double>& start,
                              const std::optional<FittedModel>& errors) {
  const Record record = record_of(columns, labels);
  const Released released;
  const auto* along = dynamic_cast<const StateBlockModel*>(model.block.get());
  if (along == nullptr) throw Error("the model has no state, and nothing to smooth");
  return smooth(*along, record, parameters,
                {.process = process, .outputs = outputs, .start = start},
                errors ? errors_of(errors->fit) : ParameterErrors{});
}

/// The first rows' fit as stages one and two have it, with what the model holds by default.
StreamStart start_of_rows(const Model& model, const Record& record, std::size_t rows,
                          const CalibrationOptions& options) {
  const Record batch = first_rows(record, rows);
  const std::shared_ptr<const BlockModel> laid = model.along ? model.along(&batch) : model.block;
  FitOptions fit =
      verbs::hold(model.probe ? model.probe->held() : model.held, laid->tables(), options).fit;
  if (model.probe) fit = model.probe->complete(fit, batch);
  return start_from_rows(*laid, record, rows, fit);
}

Tracked track_columns(const Model& model, const py::dict& columns,
                      const std::vector<std::string>& labels,
                      const std::optional<FittedModel>& start, const CalibrationOptions& options,
                      const FlightTrackOptions& asked) {
  TrackOptions how = asked.how;
  how.noise = options.fit.noise;
  const Record record = record_of(columns, labels);
  const Released released;
  CalibrationOptions batch = options;
  batch.fit = fit_of_start(*model.block, batch.fit, how);
  const StreamStart begin =
      start ? start_from_fit(start->fit) : start_of_rows(model, record, asked.start_rows, batch);
  const std::shared_ptr<const BlockModel> laid = model.along ? model.along(&record) : model.block;
  Tracked tracked{track(*laid, record, begin, how), {}};
  for (const Variable& output : laid->tables().outputs) tracked.outputs.push_back(output.name);
  return tracked;
}

}  // namespace

void define_states(py::module_& module) {
  py::class_<TrajectoryOptions>(module, "TrajectoryOptions")
      .def(py::init(&trajectory_options), py::kw_only(), "inputs"_a, "substeps"_a, "shoot"_a,
           "measured"_a, "outputs"_a, "separable"_a, "scales_about_start"_a);
  py::class_<StateTables>(module, "StateTables")
      .def(py::init(&state_tables), "tables"_a, "linear_dynamic"_a, "linear_in_state"_a, "scales"_a,
           "acts_on"_a, "discrete"_a);
  module.def("smooth", &smooth_columns);
  module.def("track", &track_columns);
  module.def("python_state_model", &python_state_model);
  module.def("flight_path", &flight_path);
  module.def("short_period", [](const TrajectoryOptions& options) {
    Model model = lay(ShortPeriod{}, options);
    model.own = own_model("short-period", ShortPeriod{}, options);
    return model;
  });
}

}  // namespace sepcal::bindings
