// SPDX-License-Identifier: BSD-3-Clause
#include "options_json.hpp"

#include <map>
#include <vector>

#include "sepcal/error.hpp"

namespace sepcal {

Json write_options(const Calibration& calibration) {
  const FitOptions& fit = calibration.options.fit;
  Json options = Json::object();
  for (const auto& [name, values] : calibration.probe->settings()) {
    options[name] = values.size() == 1 ? Json(values.front()) : Json(values);
  }
  options["effects"] = Json::array();
  options["stage_one"] = fit.stage_one_segments;
  options["stage_two"] = fit.stage_two_segments;
  options["bounds"] = Json::object();
  for (const auto& [name, bounds] : fit.bounds) {
    options["bounds"][name] = {number(bounds.lower), number(bounds.upper)};
  }
  options["fix"] = fit.fixed;
  options["free"] = calibration.options.free;
  options["noise"] = fit.noise;
  options["samples"] = fit.samples;
  options["sampling"] = fit.sampling == Sampling::uniform ? "uniform" : "low_discrepancy";
  options["priors"] = Json::object();
  for (const auto& [name, prior] : fit.priors) {
    options["priors"][name] = {prior.mean, prior.standard_deviation};
  }
  options["seed"] = fit.seed;
  options["descents"] = fit.descents;
  options["second_stage"] = to_string(fit.second_stage);
  options["noise_tolerance"] = fit.noise_tolerance;
  options["noise_iterations"] = fit.noise_iterations;
  options["iterations"] = fit.iterations;
  options["threads"] = fit.threads;
  options["drop_invalid"] = calibration.options.drop_invalid;
  return options;
}

SecondStage second_stage_of(const std::string& name) {
  for (const SecondStage method :
       {SecondStage::automatic, SecondStage::joint, SecondStage::projected}) {
    if (to_string(method) == name) return method;
  }
  throw Error("second_stage '" + name + "' is unknown");
}

CalibrationOptions read_options(const Json& options) {
  CalibrationOptions result;
  FitOptions& fit = result.fit;
  fit.stage_one_segments = options.at("stage_one").get<std::string>();
  fit.stage_two_segments = options.at("stage_two").get<std::string>();
  for (const auto& [name, bounds] : options.at("bounds").items()) {
    fit.bounds[name] = {number_or(bounds.at(0), -infinity), number_or(bounds.at(1), infinity)};
  }
  fit.fixed = options.at("fix").get<std::map<std::string, double>>();
  result.free = options.at("free").get<std::vector<std::string>>();
  fit.noise = options.at("noise").get<std::map<std::string, double>>();
  fit.samples = options.at("samples").get<int>();
  fit.sampling = options.at("sampling").get<std::string>() == "uniform" ? Sampling::uniform
                                                                        : Sampling::low_discrepancy;
  for (const auto& [name, prior] : options.at("priors").items()) {
    fit.priors[name] = {prior.at(0).get<double>(), prior.at(1).get<double>()};
  }
  fit.seed = options.at("seed").get<std::uint64_t>();
  fit.descents = options.at("descents").get<int>();
  fit.second_stage = second_stage_of(options.at("second_stage").get<std::string>());
  fit.noise_tolerance = options.at("noise_tolerance").get<double>();
  fit.noise_iterations = options.at("noise_iterations").get<int>();
  fit.iterations = options.at("iterations").get<int>();
  fit.threads = options.at("threads").get<int>();
  result.drop_invalid = options.at("drop_invalid").get<bool>();
  return result;
}

std::shared_ptr<const Probe> read_probe(const std::string& model, const Json& options) {
  std::map<std::string, std::vector<double>> settings;
  for (const char* name : {"k_alpha", "k_beta", "lever_arm", "field"}) {
    if (!options.contains(name)) continue;
    const Json& value = options.at(name);
    settings[name] = value.is_array() ? value.get<std::vector<double>>()
                                      : std::vector<double>{value.get<double>()};
  }
  return make_probe(model, settings);
}

}  // namespace sepcal
