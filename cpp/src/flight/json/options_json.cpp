// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/options_json.hpp"

#include <map>
#include <vector>

#include "base/thread_pool.hpp"
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/error.hpp"

namespace sepcal::json {
namespace {

/// {name: [mean, standard deviation]}.
Json write_normals(const std::map<std::string, Normal>& normals) {
  Json object = Json::object();
  for (const auto& [name, normal] : normals) {
    object[name] = {normal.mean, normal.standard_deviation};
  }
  return object;
}

std::map<std::string, Normal> read_normals(const Json& object) {
  std::map<std::string, Normal> normals;
  for (const auto& [name, normal] : entries_of(object)) {
    normals[name] = {normal.at(0).get<double>(), normal.at(1).get<double>()};
  }
  return normals;
}

template <class Choice>
void read_choice(const Json& options, const char* name, Choice& choice) {
  choice = choice_of<Choice>(name, options.at(name).get<std::string>());
}

Json write_screens(const Screens& screens) {
  return {{"t_1", number(screens.t_1)},
          {"t_2", number(screens.t_2)},
          {"l_2", screens.l_2},
          {"convex", screens.convex}};
}

Screens read_screens(const Json& object) {
  return {.t_1 = number_or(object.at("t_1"), infinity),
          .t_2 = number_or(object.at("t_2"), infinity),
          .l_2 = object.at("l_2").get<double>(),
          .convex = object.at("convex").get<bool>()};
}

Json write_effect(const EffectSetting& setting) {
  Json effect = {{"name", setting.name}};
  if (setting.centre) effect["centre"] = *setting.centre;
  if (setting.mean) effect["mean"] = *setting.mean;
  if (!setting.knots.empty()) effect["knots"] = setting.knots;
  if (!setting.means.empty()) effect["means"] = setting.means;
  if (!setting.labels.empty()) effect["labels"] = setting.labels;
  if (setting.span) effect["span"] = {setting.span->first, setting.span->second};
  if (setting.t0) effect["t0"] = *setting.t0;
  return effect;
}

EffectSetting read_effect(const Json& object) {
  EffectSetting setting{.name = object.at("name").get<std::string>()};
  if (object.contains("centre")) setting.centre = object.at("centre").get<double>();
  if (object.contains("mean")) setting.mean = object.at("mean").get<double>();
  if (object.contains("knots")) setting.knots = object.at("knots").get<std::vector<double>>();
  if (object.contains("means")) setting.means = object.at("means").get<std::vector<double>>();
  if (object.contains("labels")) {
    setting.labels = object.at("labels").get<std::vector<std::string>>();
  }
  if (object.contains("span")) {
    setting.span = {object.at("span").at(0).get<double>(), object.at("span").at(1).get<double>()};
  }
  if (object.contains("t0")) setting.t0 = object.at("t0").get<double>();
  setting.known = true;
  return setting;
}

void write_choice(const LogChoice& log, Json& options) {
  options["drop_invalid"] = log.drop_invalid;
  if (!log.drop_repeats.empty()) options["drop_repeats"] = log.drop_repeats;
  if (!log.map.empty()) options["map"] = log.map;
  if (!log.ignore.empty()) options["ignore"] = log.ignore;
  if (!log.where.empty()) options["where"] = log.where;
  if (log.from_time) options["from_time"] = *log.from_time;
  if (log.to_time) options["to_time"] = *log.to_time;
}

template <class Value>
void read_optional(const Json& options, const char* name, Value& value) {
  if (options.contains(name)) value = options.at(name).get<Value>();
}

LogChoice read_choice_of_log(const Json& options) {
  LogChoice log{.drop_invalid = options.at("drop_invalid").get<bool>()};
  read_optional(options, "drop_repeats", log.drop_repeats);
  read_optional(options, "map", log.map);
  read_optional(options, "ignore", log.ignore);
  read_optional(options, "where", log.where);
  if (options.contains("from_time")) log.from_time = options.at("from_time").get<double>();
  if (options.contains("to_time")) log.to_time = options.at("to_time").get<double>();
  return log;
}

}  // namespace

Json write_trajectory(const TrajectoryOptions& along) {
  return {{"inputs_between_rows", to_string(along.inputs)},
          {"substeps", along.substeps},
          {"shoot", number(along.shoot)},
          {"measured", along.measured},
          {"outputs", along.outputs},
          {"scales_about_start", along.scales_about_start}};
}

Json write_options(const Calibration& calibration) {
  Json options = Json::object();
  for (const auto& [name, values] : calibration.probe->settings()) {
    options[name] = values.size() == 1 ? Json(values.front()) : Json(values);
  }
  options.update(write_options(calibration.options));
  return options;
}

Json write_options(const CalibrationOptions& chosen) {
  const FitOptions& fit = chosen.fit;
  Json options = Json::object();
  options["effects"] = Json::array();
  for (const EffectSetting& setting : chosen.effects) {
    options["effects"].push_back(write_effect(setting));
  }
  options["stage_one_segments"] = fit.stage_one_segments;
  options["stage_two_segments"] = fit.stage_two_segments;
  options["bounds"] = Json::object();
  for (const auto& [name, bounds] : fit.bounds) {
    options["bounds"][name] = {number(bounds.lower), number(bounds.upper)};
  }
  options["start"] = fit.start;
  options["fix"] = fit.fix;
  options["free"] = chosen.free;
  options["noise"] = fit.noise;
  options["prior"] = write_normals(fit.prior);
  options["search"] = to_string(fit.search);
  options["samples"] = fit.samples;
  options["sampling"] = to_string(fit.sampling);
  options["sampling_distribution"] = write_normals(fit.sampling_distribution);
  if (fit.screens) options["screens"] = write_screens(*fit.screens);
  options["seed"] = fit.seed;
  options["descents"] = fit.descents;
  options["second_stage"] = to_string(fit.second_stage);
  options["jacobian"] = to_string(fit.jacobian);
  options["loss"] = to_string(fit.loss);
  options["loss_width"] = fit.loss_width;
  options["noise_tolerance"] = fit.noise_tolerance;
  options["noise_iterations"] = fit.noise_iterations;
  options["iterations"] = fit.iterations;
  options["coloured_errors"] = fit.coloured_errors;
  if (fit.method != FitMethod::output_error) {
    options["method"] = to_string(fit.method);
    options["hessian"] = to_string(fit.hessian);
  }
  if (!fit.process_noise.empty()) options["process_noise"] = fit.process_noise;
  options["threads"] = fit.threads;
  write_choice(chosen.log, options);
  return options;
}

CalibrationOptions read_options(const Json& options) {
  CalibrationOptions result;
  FitOptions& fit = result.fit;
  fit.stage_one_segments = options.at("stage_one_segments").get<std::string>();
  fit.stage_two_segments = options.at("stage_two_segments").get<std::string>();
  for (const auto& [name, bounds] : entries_of(options.at("bounds"))) {
    fit.bounds[name] = {number_or(bounds.at(0), -infinity), number_or(bounds.at(1), infinity)};
  }
  for (const Json& effect : elements_of(options.at("effects"))) {
    result.effects.push_back(read_effect(effect));
  }
  fit.start = options.at("start").get<std::map<std::string, double>>();
  fit.fix = options.at("fix").get<std::map<std::string, double>>();
  result.free = options.at("free").get<std::vector<std::string>>();
  fit.noise = options.at("noise").get<std::map<std::string, double>>();
  fit.prior = read_normals(options.at("prior"));
  read_choice(options, "search", fit.search);
  fit.samples = whole_number<int>(options.at("samples"));
  read_choice(options, "sampling", fit.sampling);
  fit.sampling_distribution = read_normals(options.at("sampling_distribution"));
  if (options.contains("screens")) fit.screens = read_screens(options.at("screens"));
  fit.seed = whole_number<std::uint64_t>(options.at("seed"));
  fit.descents = whole_number<int>(options.at("descents"));
  read_choice(options, "second_stage", fit.second_stage);
  read_choice(options, "jacobian", fit.jacobian);
  read_choice(options, "loss", fit.loss);
  fit.loss_width = options.at("loss_width").get<double>();
  fit.noise_tolerance = options.at("noise_tolerance").get<double>();
  fit.noise_iterations = whole_number<int>(options.at("noise_iterations"));
  fit.iterations = whole_number<int>(options.at("iterations"));
  fit.coloured_errors = options.at("coloured_errors").get<bool>();
  if (options.contains("method")) {
    read_choice(options, "method", fit.method);
    read_choice(options, "hessian", fit.hessian);
  }
  if (options.contains("process_noise")) {
    fit.process_noise = options.at("process_noise").get<std::map<std::string, double>>();
  }
  fit.threads = whole_number<int>(options.at("threads"));
  if (fit.threads < 0 || fit.threads > base::most_threads) {
    throw Error(describe(options.at("threads")) + " threads are none that can be had");
  }
  result.log = read_choice_of_log(options);
  return result;
}

std::shared_ptr<const Probe> read_probe(const std::string& model, const Json& options) {
  std::map<std::string, std::vector<double>> settings;
  for (const char* name :
       {"k_alpha", "k_beta", "lever_arm", "field", "mounting", "field_strength", "field_noise"}) {
    if (!options.contains(name)) continue;
    const Json& value = options.at(name);
    settings[name] = value.is_array() ? value.get<std::vector<double>>()
                                      : std::vector<double>{value.get<double>()};
  }
  return make_probe(model, settings);
}

}  // namespace sepcal::json
