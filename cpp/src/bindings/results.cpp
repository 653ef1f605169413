// SPDX-License-Identifier: BSD-3-Clause
// A fit as plain dictionaries and arrays.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "bindings.hpp"

namespace sepcal::bindings {

using namespace py::literals;

py::list describe(const std::vector<Parameter>& parameters) {
  py::list list;
  for (const Parameter& parameter : parameters) {
    list.append(py::dict("name"_a = parameter.name, "value"_a = parameter.value,
                         "standard_error"_a = parameter.standard_error,
                         "standard_error_white"_a = parameter.standard_error_white,
                         "unit"_a = parameter.unit, "lower"_a = parameter.lower,
                         "upper"_a = parameter.upper, "at_bound"_a = parameter.at_bound,
                         "fixed"_a = parameter.fixed));
  }
  return list;
}

py::list describe(const std::vector<Combination>& combinations) {
  py::list list;
  for (const Combination& combination : combinations) {
    list.append(py::dict("text"_a = combination.text,
                         "parameters"_a = py::tuple(py::cast(combination.parameters)),
                         "standard_error"_a = combination.standard_error));
  }
  return list;
}

py::dict describe(const std::vector<OutputValue>& values) {
  py::dict dictionary;
  for (const OutputValue& value : values) dictionary[py::str(value.name)] = value.value;
  return dictionary;
}

namespace {

/// {name: value} of the parameters that stage one samples: nonlinear and not fixed.
py::dict describe_point(const Fit& fit, const Eigen::VectorXd& xi2) {
  py::dict point;
  Eigen::Index k = 0;
  for (auto at = fit.parameters.begin() + fit.n_1; at != fit.parameters.end(); ++at) {
    if (!at->fixed && k < xi2.size()) point[py::str(at->name)] = xi2[k++];
  }
  return point;
}

py::object describe(const std::optional<ScreenResults>& screens) {
  if (!screens) return py::none();
  return py::dict("ratio_a"_a = screens->ratio_a, "ratio_b"_a = screens->ratio_b,
                  "curvature_a"_a = screens->curvature_a, "curvature_b"_a = screens->curvature_b,
                  "accepted"_a = screens->accepted);
}

py::dict describe_stage_one(const Fit& fit) {
  const StageOne& stage_one = fit.stage_one;
  py::list minima;
  for (const LocalMinimum& minimum : stage_one.minima) {
    minima.append(
        py::dict("xi2"_a = describe_point(fit, minimum.xi2), "trace_r"_a = minimum.trace_r));
  }
  return py::dict(
      "samples"_a = Eigen::MatrixXd(stage_one.samples.transpose()), "trace_r"_a = stage_one.trace_r,
      "best"_a = describe_point(fit, stage_one.best), "best_trace_r"_a = stage_one.best_trace_r,
      "minima"_a = minima, "unique_minimum"_a = stage_one.unique_minimum,
      "flat_directions"_a = stage_one.flat_directions, "screens"_a = describe(stage_one.screens));
}

/// Keys as the fields of sepcal.EffectSetting.
py::list describe(const std::vector<EffectSetting>& effects) {
  py::list list;
  for (const EffectSetting& effect : effects) {
    list.append(py::dict("name"_a = effect.name, "centre"_a = effect.centre,
                         "knots"_a = py::tuple(py::cast(effect.knots)),
                         "labels"_a = py::tuple(py::cast(effect.labels)), "span"_a = effect.span,
                         "t0"_a = effect.t0));
  }
  return list;
}

}  // namespace

py::dict describe(const Fit& fit, const CalibrationOptions& options) {
  py::dict described(
      "status"_a = to_string(fit.status), "message"_a = fit.message,
      "parameters"_a = describe(fit.parameters), "covariance"_a = fit.covariance,
      "correlation"_a = fit.correlation, "covariance_white"_a = fit.covariance_white,
      "noise"_a = describe(fit.noise), "rmse"_a = describe(fit.rmse), "cost"_a = fit.cost,
      "rows"_a = fit.rows, "unobservable"_a = describe(fit.identifiability.unobservable),
      "weak"_a = describe(fit.identifiability.weak), "stage_one"_a = describe_stage_one(fit),
      "method"_a = to_string(fit.method), "iterations"_a = fit.iterations,
      "noise_iterations"_a = fit.noise_iterations, "effects"_a = describe(options.effects));
  add_pages(described, fit, options);
  return described;
}

}  // namespace sepcal::bindings
