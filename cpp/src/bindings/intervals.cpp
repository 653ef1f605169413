// SPDX-License-Identifier: BSD-3-Clause
// Intervals by both kinds and predictions, of fits on columns and of calibrations.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <optional>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "fitted_columns.hpp"
#include "model/measurements.hpp"
#include "python_effect.hpp"
#include "released.hpp"
#include "results.hpp"
#include "sepcal/flight/intervals.hpp"
#include "structs.hpp"

namespace sepcal::bindings {
namespace {

FoundIntervals profile_columns(const Model& model, const py::dict& columns,
                               const std::vector<std::string>& labels, CalibrationOptions options,
                               const std::vector<PythonEffect>& own, const FittedModel& fitted,
                               double level, const std::vector<std::string>& names) {
  Record record = record_of(columns, labels);
  options.own_effects = own_effects(own, model.kit());
  const Released released;
  record = model::with_constant_outputs(model.block->tables(), std::move(record));
  FittedColumns prepared =
      bring_to_fit(model, std::move(record), options, fitted.effects, fitted.fit);
  if (prepared.probe) {
    prepared.options = prepared.probe->complete(prepared.options, prepared.record);
  }
  std::vector<ProfileInterval> intervals =
      profile_intervals(*prepared.model, prepared.record, fitted.fit, prepared.options,
                        {.level = level, .names = names});
  std::string json = to_json(intervals, level);
  std::string text = without_last_end(to_text(intervals, level));
  return {level, std::move(intervals), {}, std::move(json), {text, text}};
}

FlightPrediction predict_columns(const Model& model, const py::dict& columns,
                                 const std::vector<std::string>& labels, CalibrationOptions options,
                                 const std::vector<PythonEffect>& own, const FittedModel& fitted,
                                 double level) {
  Record record = record_of(columns, labels);
  options.own_effects = own_effects(own, model.kit());
  const Released released;
  const FittedColumns prepared =
      bring_to_fit(model, std::move(record), options, fitted.effects, fitted.fit);
  return {
      .time = {},
      .prediction = predict(*prepared.model, prepared.record, fitted.fit, prepared.options, level)};
}

}  // namespace

void define_intervals(py::module_& module) {
  BoundStruct<ProfileInterval>(module, "ParameterInterval",
                               "Both intervals of one parameter, (lower, upper) in `unit`.")
      .field("name", &ProfileInterval::name, "")
      .field("value", &ProfileInterval::value, "")
      .field("unit", &ProfileInterval::unit, "")
      .field("gaussian", &ProfileInterval::gaussian,
             "value -+ quantile * standard_error; NaN where there is none.")
      .field("profile", &ProfileInterval::profile, "Infinite where open, NaN where failed.")
      .field(
          "ends",
          [](const ProfileInterval& self) { return std::pair(self.lower_end, self.upper_end); },
          [](ProfileInterval& self, const std::pair<IntervalEnd, IntervalEnd>& ends) {
            std::tie(self.lower_end, self.upper_end) = ends;
          },
          R"(What ends the profile's: "crossed", "bound", "open" or "failed".)")
      .field("message", &ProfileInterval::message, "One line; empty where there is nothing to say.")
      .comparable()
      .finish();

  BoundStruct<FoundIntervals>(module, "Intervals", "Both intervals of a fit's parameters.")
      .field("level", &FoundIntervals::level, "How often an interval should hold the true value.")
      .field("parameters", &FoundIntervals::parameters, "")
      .field("notes", &FoundIntervals::notes, "One line each, for people.")
      .field("json", &FoundIntervals::json, "")
      .field("text", &FoundIntervals::page, &Page::text,
             "The text that print() shows: for a calibration's, the app's page.")
      .field("explained", &FoundIntervals::page, &Page::explained,
             "The same with the whole message, as by the apps' --explain.")
      .copied()
      .finish()
      .def("__getitem__", [](const FoundIntervals& self, const std::string& name) {
        return find_named(self.parameters, name, "interval of", "there are");
      });

  BoundStruct<FlightPrediction>(
      module, "Prediction",
      "A fit's predictions of N samples, in the outputs' units and the model's order of outputs.")
      .field("value", &FlightPrediction::prediction, &Prediction::value, "(N, n_z), A xi1 + b.")
      .field("standard_error", &FlightPrediction::prediction, &Prediction::standard_error,
             "(N, n_z), of the value, from the parameters' covariance.")
      .field("measurement_error", &FlightPrediction::prediction, &Prediction::measurement_error,
             "(N, n_z), standard deviation of a new measurement about the value.")
      .field("quantile", &FlightPrediction::prediction, &Prediction::quantile,
             "Half a band's width in these errors, by the level asked for.")
      .field(
          "time",
          [](const FlightPrediction& self) {
            return self.time.empty() ? std::nullopt : std::optional(adopt(self.time));
          },
          [](FlightPrediction& self, const std::optional<Array>& time) {
            if (time) self.time = py::cast<std::vector<double>>(*time);
          },
          "(N,) [s] of a flight's rows; None of columns.")
      .copied()
      .finish();

  module.def("profile_intervals", &profile_columns);
  module.def("predict", &predict_columns);
}

}  // namespace sepcal::bindings
