// SPDX-License-Identifier: BSD-3-Clause
// Intervals by both kinds and predictions, of fits on columns and of calibrations.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <tuple>
#include <utility>

#include "arrays.hpp"
#include "bindings.hpp"
#include "python_effect.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/flight/intervals.hpp"
#include "sepcal/flight/probe_effects.hpp"

namespace sepcal::bindings {
namespace {

using namespace py::literals;

/// Name, centre, knots, labels, span, t0: the fields of sepcal.EffectSetting.
using Setting =
    std::tuple<std::string, std::optional<double>, std::vector<double>, std::vector<std::string>,
               std::optional<std::pair<double, double>>, std::optional<double>>;

std::vector<EffectSetting> settings_of(const std::vector<Setting>& rows) {
  std::vector<EffectSetting> settings;
  for (const auto& [name, centre, knots, labels, span, t0] : rows) {
    settings.push_back({name, centre, knots, labels, span, t0, true});
  }
  return settings;
}

Parameter parameter_of(const py::dict& fields) {
  return {.name = py::cast<std::string>(fields["name"]),
          .unit = py::cast<std::string>(fields["unit"]),
          .value = py::cast<double>(fields["value"]),
          .standard_error = py::cast<double>(fields["standard_error"]),
          .standard_error_white = py::cast<double>(fields["standard_error_white"]),
          .lower = py::cast<double>(fields["lower"]),
          .upper = py::cast<double>(fields["upper"]),
          .at_bound = py::cast<bool>(fields["at_bound"]),
          .fixed = py::cast<bool>(fields["fixed"])};
}

/// What intervals and predictions take of a sepcal.Fit, by the names of its fields; n_1 is the
/// model's to tell.
Fit fit_of(const py::dict& fields) {
  Fit fit;
  const auto status = py::cast<std::string>(fields["status"]);
  for (const FitStatus known : {FitStatus::converged, FitStatus::not_identifiable}) {
    if (status == to_string(known)) fit.status = known;
  }
  for (const py::handle parameter : fields["parameters"]) {
    fit.parameters.push_back(parameter_of(py::cast<py::dict>(parameter)));
  }
  fit.covariance = py::cast<Eigen::MatrixXd>(fields["covariance"]);
  for (const auto& [name, value] : py::cast<py::dict>(fields["noise"])) {
    fit.noise.push_back({py::cast<std::string>(name), py::cast<double>(value)});
  }
  fit.cost = py::cast<double>(fields["cost"]);
  fit.rows = py::cast<std::size_t>(fields["rows"]);
  fit.method = py::cast<std::string>(fields["method"]) == to_string(SecondStage::projected)
                   ? SecondStage::projected
                   : SecondStage::joint;
  return fit;
}

/// Columns brought to the model that was fitted to them or their like.
struct Prepared {
  std::shared_ptr<const Probe> probe;
  std::shared_ptr<const BlockModel> model;
  Record record;
  FitOptions options;
};

Prepared prepare(const Model& model, Record record, const CalibrationOptions& options,
                 std::vector<EffectSetting> settings, const Fit& fit) {
  Prepared result{model.probe, model.block, std::move(record), options.fit};
  EffectKit kit = model.probe ? effect_kit(model.probe->name()) : plain_kit(model.block->tables());
  for (const auto& [name, maker] : options.own_effects) kit.own[name] = maker;
  if (result.probe) {
    std::shared_ptr<const Probe> told = result.probe->with_noise(fit.noise.front().value);
    if (told) {
      result.probe = std::move(told);
      result.model = {result.probe, &result.probe->model()};
    }
  }
  const std::vector<Effect> effects = make_effects(kit, *result.model, settings, result.record);
  result.model = compose(result.model, effects, result.record);
  result.record = without_edges(std::move(result.record), reach(effects, options.fit.bounds));
  result.options.unsampled.merge(initial_corrections(effects));
  return result;
}

py::dict describe(const std::vector<ProfileInterval>& intervals) {
  py::dict by_name;
  for (const ProfileInterval& at : intervals) {
    by_name[py::str(at.name)] =
        py::dict("name"_a = at.name, "value"_a = at.value, "unit"_a = at.unit,
                 "gaussian"_a = py::make_tuple(at.gaussian.lower, at.gaussian.upper),
                 "profile"_a = py::make_tuple(at.profile.lower, at.profile.upper),
                 "ends"_a = py::make_tuple(to_string(at.lower_end), to_string(at.upper_end)),
                 "message"_a = at.message);
  }
  return by_name;
}

py::dict describe(const Prediction& prediction) {
  return py::dict("value"_a = prediction.value, "standard_error"_a = prediction.standard_error,
                  "measurement_error"_a = prediction.measurement_error,
                  "quantile"_a = prediction.quantile);
}

/// A record with the outputs that need not be measured.
void add_constant_outputs(const BlockModel& model, Record& record) {
  for (const Variable& output : model.tables().outputs) {
    if (record.has(output.name) || !std::isfinite(output.absent)) continue;
    record.add(output.name, std::vector<double>(record.length(), output.absent));
  }
}

py::dict profile_columns(const Model& model, const py::dict& columns,
                         const std::vector<std::string>& labels, CalibrationOptions options,
                         const std::vector<PythonEffect>& own, const py::dict& fitted,
                         const std::vector<Setting>& settings, const ProfileOptions& asked) {
  Record record = record_of(columns, labels);
  Fit fit = fit_of(fitted);
  options.own_effects = own_effects(
      own, model.probe ? effect_kit(model.probe->name()) : plain_kit(model.block->tables()));
  const auto run = [&] {
    const py::gil_scoped_release release;
    add_constant_outputs(*model.block, record);
    Prepared prepared = prepare(model, std::move(record), options, settings_of(settings), fit);
    fit.n_1 = prepared.model->tables().n_1();
    if (prepared.probe) {
      prepared.options = prepared.probe->complete(prepared.options, prepared.record);
    }
    return profile_intervals(*prepared.model, prepared.record, fit, prepared.options, asked);
  };
  const std::vector<ProfileInterval> intervals = run();
  const std::string page = without_last_end(to_text(intervals, asked.level));
  return py::dict("level"_a = asked.level, "parameters"_a = describe(intervals),
                  "notes"_a = std::vector<std::string>(),
                  "json"_a = to_json(intervals, asked.level), "text"_a = page,
                  "explained"_a = page);
}

py::dict predict_columns(const Model& model, const py::dict& columns,
                         const std::vector<std::string>& labels, CalibrationOptions options,
                         const std::vector<PythonEffect>& own, const py::dict& fitted,
                         const std::vector<Setting>& settings, double level) {
  Record record = record_of(columns, labels);
  Fit fit = fit_of(fitted);
  options.own_effects = own_effects(
      own, model.probe ? effect_kit(model.probe->name()) : plain_kit(model.block->tables()));
  const auto run = [&] {
    const py::gil_scoped_release release;
    const Prepared prepared = prepare(model, record, options, settings_of(settings), fit);
    fit.n_1 = prepared.model->tables().n_1();
    return predict(*prepared.model, prepared.record, fit, prepared.options, level);
  };
  return describe(run());
}

}  // namespace

py::dict find_intervals(const Calibration& calibration, const Flight& flight, double level,
                        const std::vector<std::string>& names) {
  const auto run = [&] {
    const py::gil_scoped_release release;
    need_own_effects(calibration);
    return sepcal::find_intervals(calibration, flight, {.level = level, .names = names});
  };
  const FlightIntervals intervals = run();
  py::dict described("level"_a = level, "parameters"_a = describe(intervals.parameters),
                     "notes"_a = intervals.notes, "json"_a = to_json(intervals));
  add_pages(described, intervals);
  return described;
}

py::dict predict(const Calibration& calibration, const Flight& flight, double level) {
  const auto run = [&] {
    const py::gil_scoped_release release;
    need_own_effects(calibration);
    return sepcal::predict(calibration, flight, level);
  };
  FlightPrediction predicted = run();
  py::dict described = describe(predicted.prediction);
  described["time"] = adopt(std::move(predicted.time));
  return described;
}

void define_intervals(py::module_& module) {
  module.def("profile_intervals",
             [](const Model& model, const py::dict& columns, const std::vector<std::string>& labels,
                CalibrationOptions options, const std::vector<PythonEffect>& own,
                const py::dict& fitted, const std::vector<Setting>& settings, double level,
                const std::vector<std::string>& names) {
               return profile_columns(model, columns, labels, std::move(options), own, fitted,
                                      settings, {.level = level, .names = names});
             });
  module.def("predict", &predict_columns);
}

}  // namespace sepcal::bindings
