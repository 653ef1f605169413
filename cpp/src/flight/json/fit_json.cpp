// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/fit_json.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/collinear_directions.hpp"
#include "flight/json/findings_json.hpp"
#include "flight/json/result_json.hpp"
#include "sepcal/collinearity.hpp"

namespace sepcal::json {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double undefined = not_a_number;

std::vector<std::string> estimated_names(const Fit& fit) {
  std::vector<std::string> names;
  for (const Parameter& parameter : fit.parameters) {
    if (!parameter.fixed) names.push_back(parameter.name);
  }
  return names;
}

std::vector<std::string> sampled_names(const Fit& fit) {
  std::vector<std::string> names;
  for (auto k = static_cast<std::size_t>(fit.n_1); k < fit.parameters.size(); ++k) {
    if (!fit.parameters[k].fixed) names.push_back(fit.parameters[k].name);
  }
  return names;
}

std::vector<Index> estimated_indices(const Fit& fit) {
  std::vector<Index> indices;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    if (!fit.parameters[k].fixed) indices.push_back(static_cast<Index>(k));
  }
  return indices;
}

// --- parameters

Json write_parameters(const Fit& fit) {
  Json parameters = write_by_name(fit.parameters, &Parameter::name);
  int k = 0;
  for (const Parameter& parameter : fit.parameters) {
    parameters[parameter.name]["kind"] = k++ < fit.n_1 ? "linear" : "nonlinear";
  }
  return parameters;
}

/// Whether a parameter was held: by an option, or at the time that a step was found at.
bool is_held(const CalibrationOptions& options, const std::string& name) {
  if (options.fit.fix.contains(name)) return true;
  return std::ranges::any_of(options.effects, [&](const EffectSetting& setting) {
    return setting.t0 && name == setting.name + ".t0";
  });
}

void read_parameters(const Json& parameters, const CalibrationOptions& options, Fit& fit) {
  for (const auto& [name, entry] : entries_of(parameters)) {
    auto parameter = read_fields<Parameter>(entry);
    parameter.name = name;
    parameter.fixed = is_held(options, name);
    fit.parameters.push_back(std::move(parameter));
    if (entry.at("kind") == "linear") ++fit.n_1;
  }
}

/// Correlation holds all that the covariance does beyond the standard errors. Of the others nothing
/// but the standard errors is kept.
void read_correlation(const Json& correlation, Fit& fit) {
  const auto n = static_cast<Index>(fit.parameters.size());
  fit.correlation = Eigen::MatrixXd::Constant(n, n, undefined);
  const std::vector<Index> indices = estimated_indices(fit);
  fit.correlation(indices, indices) =
      matrix_of(correlation.at("matrix"), static_cast<Index>(indices.size()));
  VectorXd errors(n);
  fit.covariance_white = Eigen::MatrixXd::Constant(n, n, undefined);
  fit.covariance_noise_model = fit.covariance_blocks = fit.covariance_white;
  for (Index k = 0; k < n; ++k) {
    const Parameter& parameter = fit.parameters[static_cast<std::size_t>(k)];
    errors[k] = parameter.standard_error;
    fit.covariance_white(k, k) = std::pow(parameter.standard_error_white, 2);
    fit.covariance_noise_model(k, k) = std::pow(parameter.standard_error_noise_model, 2);
    fit.covariance_blocks(k, k) = std::pow(parameter.standard_error_blocks, 2);
  }
  fit.covariance = errors.asDiagonal() * fit.correlation * errors.asDiagonal();
}

/// What follows of the correlation; a reader finds it again.
Json write_collinearity(const Fit& fit) {
  const Collinearity found = find_collinearity(fit);
  Json pairs = Json::array();
  for (const CorrelatedPair& pair : found.pairs) {
    pairs.push_back({{"first", pair.first},
                     {"second", pair.second},
                     {"correlation", number(pair.correlation)}});
  }
  Json directions = Json::array();
  for (const estimation::CollinearDirection& one : estimation::collinear_directions(found)) {
    directions.push_back({{"condition_index", number(one.condition_index)},
                          {"variance_proportions", by_name(one.proportions)}});
  }
  return {{"pairs", pairs}, {"directions", directions}};
}

// --- filter error

Json write_filter_error(const Fit& fit) {
  return {{"noise_sizes", write_by_name(fit.noise_sizes, &NoiseSize::name)},
          {"log_likelihood", number(fit.log_likelihood)},
          {"log_likelihood_without", number(fit.log_likelihood_without)}};
}

void read_filter_error(const Json& object, Fit& fit) {
  fit.method = FitMethod::filter_error;
  fit.log_likelihood = number_or(object.at("log_likelihood"), undefined);
  fit.log_likelihood_without = number_or(object.at("log_likelihood_without"), undefined);
  for (const auto& [name, entry] : entries_of(object.at("noise_sizes"))) {
    fit.noise_sizes.push_back(read_fields<NoiseSize>(entry));
    fit.noise_sizes.back().name = name;
  }
}

// --- stages

Json write_stage_one(const Fit& fit, const FitOptions& options) {
  const std::vector<std::string> names = sampled_names(fit);
  Json minima = Json::array();
  for (const LocalMinimum& minimum : fit.stage_one.minima) {
    minima.push_back({{"xi2", point(names, minimum.xi2)}, {"trace_r", number(minimum.trace_r)}});
  }
  return {{"samples", options.samples},
          {"best", point(names, fit.stage_one.best)},
          {"trace_r", number(fit.stage_one.best_trace_r)},
          {"minima", minima},
          {"unique_minimum", fit.stage_one.unique_minimum},
          {"flat_directions", fit.stage_one.flat_directions}};
}

StageOne read_stage_one(const Json& object, const Fit& fit) {
  const std::vector<std::string> names = sampled_names(fit);
  StageOne stage_one;
  stage_one.best = point_of(names, object.at("best"));
  stage_one.best_trace_r = number_or(object.at("trace_r"), undefined);
  for (const Json& minimum : elements_of(object.at("minima"))) {
    stage_one.minima.push_back(
        {point_of(names, minimum.at("xi2")), number_or(minimum.at("trace_r"), undefined)});
  }
  stage_one.unique_minimum = object.at("unique_minimum").get<bool>();
  stage_one.flat_directions = object.at("flat_directions").get<std::vector<std::string>>();
  return stage_one;
}

FitStatus status_of(const std::string& name) {
  for (const FitStatus status :
       {FitStatus::converged, FitStatus::not_converged, FitStatus::not_identifiable}) {
    if (to_string(status) == name) return status;
  }
  throw Error("status '" + name + "' is unknown");
}

}  // namespace

Json write_inputs(const FittedFlight& flight) {
  return {{"file", flight.file},
          {"sha256", flight.sha256},
          {"rows", flight.rows},
          {"rows_used", flight.rows_used}};
}

FittedFlight read_inputs(const Json& inputs) {
  return {inputs.at("file").get<std::string>(), files::sha256_of(inputs.at("sha256")),
          whole_number<std::size_t>(inputs.at("rows")),
          whole_number<std::size_t>(inputs.at("rows_used"))};
}

void write_estimates(const Fit& fit, Json& root) {
  root["status"] = to_string(fit.status);
  root["message"] = fit.message;
  root["parameters"] = write_parameters(fit);
}

void write_rest(const Fit& fit, const FitOptions& options, Json& root) {
  const std::vector<Index> estimated = estimated_indices(fit);
  const auto n = static_cast<Index>(fit.parameters.size());
  const Eigen::MatrixXd correlation =
      fit.correlation.rows() == n ? fit.correlation : Eigen::MatrixXd::Constant(n, n, undefined);
  root["correlation"] = {{"names", estimated_names(fit)},
                         {"matrix", matrix(correlation(estimated, estimated))}};
  root["collinearity"] = write_collinearity(fit);
  root["unobservable"] = write_combinations(fit.identifiability.unobservable);
  root["weak"] = write_combinations(fit.identifiability.weak);
  root["cost"] = number(fit.cost);
  root["rmse"] = by_name(fit.rmse);
  root["noise"] = by_name(fit.noise);
  if (fit.method == FitMethod::filter_error) root["filter_error"] = write_filter_error(fit);
  root["iterations"] = fit.iterations;
  root["stage_one"] = write_stage_one(fit, options);
  root["stage_two"] = {{"second_stage", to_string(fit.second_stage)},
                       {"r_iterations", fit.noise_iterations}};
}

Fit read_fit(const Json& root, const CalibrationOptions& options,
             const std::vector<std::string>& outputs) {
  Fit fit;
  fit.status = status_of(root.at("status").get<std::string>());
  fit.message = root.at("message").get<std::string>();
  read_parameters(root.at("parameters"), options, fit);
  read_correlation(root.at("correlation"), fit);
  fit.identifiability.unobservable = read_combinations(root.at("unobservable"));
  fit.identifiability.weak = read_combinations(root.at("weak"));
  fit.cost = number_or(root.at("cost"), undefined);
  fit.rmse = values_by_name(outputs, root.at("rmse"));
  fit.noise = values_by_name(outputs, root.at("noise"));
  if (root.contains("filter_error")) read_filter_error(root.at("filter_error"), fit);
  fit.iterations = whole_number<int>(root.at("iterations"));
  fit.stage_one = read_stage_one(root.at("stage_one"), fit);
  fit.second_stage = choice_of<SecondStage>(
      "stage_two.second_stage", root.at("stage_two").at("second_stage").get<std::string>());
  fit.noise_iterations = whole_number<int>(root.at("stage_two").at("r_iterations"));
  return fit;
}

}  // namespace sepcal::json
