// SPDX-License-Identifier: BSD-3-Clause
// Many trials of one design, on columns that are the model's own inputs and outputs.
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "flight/verbs/held_options.hpp"
#include "released.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit_trials.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::bindings {
namespace {

/// The options of each fit, with what the model holds.
FitOptions trial_options(const Model& model, const CalibrationOptions& given,
                         const Record& design) {
  if (!given.effects.empty()) {
    throw Error(
        "fit_trials() takes no effects; fit each trial by itself, or write them into a "
        "model of your own");
  }
  if (model.probe == nullptr) {
    if (!given.free.empty() && model.held.empty()) {
      throw Error("free is for sepcal's own probes: this model holds no parameter by default");
    }
    return verbs::hold(model.held, model.block->tables(), given).fit;
  }
  if (model.probe->with_noise(1.0) != nullptr) {
    throw Error(
        "a model of the field's strength alone depends on its own noise, which "
        "fit_trials() does not follow; fit each trial by itself");
  }
  return model.probe->complete(verbs::hold(*model.probe, given).fit, design);
}

/// What the probe says of each trial's estimates, as it does after a fit.
void judge(const Probe& probe, TrialFits& fits) {
  Fit fit;
  for (const std::string& name : fits.names) fit.parameters.emplace_back().name = name;
  for (std::size_t trial = 0; trial < fits.status.size(); ++trial) {
    if (fits.failures.contains(trial)) continue;
    for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(trial);
      const auto column = static_cast<Eigen::Index>(k);
      fit.parameters[k].value = fits.estimates(row, column);
      fit.parameters[k].standard_error = fits.standard_errors(row, column);
    }
    fit.status = fits.status[trial];
    const auto message = fits.messages.find(trial);
    fit.message = message == fits.messages.end() ? "" : message->second;
    probe.judge(fit);
    fits.status[trial] = fit.status;
    if (!fit.message.empty()) fits.messages[trial] = std::move(fit.message);
  }
}

/// Names, estimates (K x n), standard errors (K x n), squared residuals (K x n_z), statuses,
/// whether in lanes, parameters estimated, rows, messages, failures.
using Fits = std::tuple<std::vector<std::string>, Eigen::MatrixXd, Eigen::MatrixXd, Eigen::MatrixXd,
                        std::vector<std::string>, std::vector<bool>, std::size_t, std::size_t,
                        std::map<std::size_t, std::string>, std::map<std::size_t, std::string>>;

Fits fit_all(const Model& model, const py::dict& columns, const std::vector<std::string>& labels,
             const std::vector<std::pair<std::string, Array>>& measured,
             const CalibrationOptions& options) {
  const Record design = record_of(columns, labels);
  std::vector<TrialOutput> outputs;
  for (const auto& [name, array] : measured) {
    outputs.push_back({name, {array.data(), static_cast<std::size_t>(array.size())}});
  }
  const Released released;
  TrialFits fits = fit_trials(*model.block, design, outputs, trial_options(model, options, design));
  if (model.probe != nullptr) judge(*model.probe, fits);
  std::vector<std::string> statuses;
  statuses.reserve(fits.status.size());
  for (const FitStatus status : fits.status) statuses.emplace_back(to_string(status));
  return {std::move(fits.names),
          std::move(fits.estimates),
          std::move(fits.standard_errors),
          std::move(fits.squared_residuals),
          std::move(statuses),
          std::move(fits.in_lanes),
          fits.estimated,
          fits.rows,
          std::move(fits.messages),
          std::move(fits.failures)};
}

}  // namespace

void define_trials(py::module_& module) { module.def("fit_trials", &fit_all); }

}  // namespace sepcal::bindings
