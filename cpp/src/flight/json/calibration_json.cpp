// SPDX-License-Identifier: BSD-3-Clause
// BASE.json, written and read. Every key of interface.md's "Results" is here and nowhere else.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <utility>

#include "base/escaping.hpp"
#include "flight/catalogue/effect_table.hpp"
#include "flight/files/text_file.hpp"
#include "flight/json/earlier_versions.hpp"
#include "flight/json/findings_json.hpp"
#include "flight/json/fit_json.hpp"
#include "flight/json/joint_json.hpp"
#include "flight/json/options_json.hpp"
#include "flight/json/output_values.hpp"
#include "flight/json/result_json.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal {

using namespace json;  // this room's own

namespace {

std::vector<std::string> output_names(const Probe& probe) {
  std::vector<std::string> names;
  for (const Variable& output : probe.model().tables().outputs) names.push_back(output.name);
  return names;
}

/// Throws Error where an effect is listed twice, or a parameter's effect is not. A model may have
/// dots in names of its own, as sensors side by side do.
void check_effects(const Calibration& calibration) {
  const std::vector<EffectSetting>& effects = calibration.options.effects;
  for (auto one = effects.begin(); one != effects.end(); ++one) {
    if (std::ranges::find(effects.begin(), one, one->name, &EffectSetting::name) != one) {
      throw Error("it lists the effect " + one->name + " twice");
    }
  }
  if (!calibration.departures.empty()) return;  // parameters are called by their flights too
  const std::vector<Variable> lasting = lasting_parameters(*calibration.probe);
  for (const Parameter& parameter : calibration.fit.parameters) {
    if (std::ranges::find(lasting, parameter.name, &Variable::name) != lasting.end()) continue;
    const auto is_of = [&](const EffectSetting& effect) {
      return parameter.name.starts_with(effect.name + ".");
    };
    if (parameter.name.find('.') != std::string::npos && std::ranges::none_of(effects, is_of)) {
      throw Error("it has the parameter " + parameter.name + " of an effect that it does not list");
    }
  }
}

/// {name: unit}.
Json write_units(const std::vector<Variable>& table) {
  Json units = Json::object();
  for (const Variable& variable : table) units[variable.name] = variable.unit;
  return units;
}

/// Of a model of the caller's own, what its tables say: its author may change them.
Json write_tables(const Probe& probe) {
  const Tables& tables = probe.model().tables();
  return {{"inputs", write_units(tables.inputs)},
          {"outputs", write_units(tables.outputs)},
          {"parameters", write_units(lasting_parameters(probe))}};
}

/// Throws Error where the model would be laid along a record otherwise than it was. Outputs that
/// are measured stand in the tables.
void check_trajectory(const Json& fitted, const TrajectoryOptions& given,
                      const std::string& source) {
  const auto sorted = [](Json value) {
    if (value.is_array()) std::sort(value.begin(), value.end());
    return value;
  };
  const auto in_words = [](const Json& value) { return value.is_null() ? "none" : value.dump(); };
  const Json as_given = write_trajectory(given);
  for (const auto& [option, value] : as_given.items()) {
    if (option == "outputs" || !fitted.contains(option)) continue;
    if (sorted(fitted[option]) == sorted(value)) continue;
    throw Error(fmt::format(
        "{}: the model was fitted with {} = {}, and the one given has {}; give it as it was fitted",
        source, option == "inputs_between_rows" ? "inputs" : option, in_words(fitted[option]),
        in_words(value)));
  }
}

/// That the file with the model is another than at the fit; empty where it isn't, or is not known.
std::string say_changed(const Json& root, const Probe& own) {
  const ModelSource* const now = own.source();
  if (now == nullptr || now->sha256.empty() || !root.contains("source")) return "";
  const std::string then = files::sha256_of(root.at("source").at("sha256"));
  if (then.empty() || then == now->sha256) return "";
  return fmt::format(
      "{} has changed since the fit: if what the model computes has, fit again; the parameters are "
      "those of the model as it was",
      now->name);
}

Calibration read(const Json& root, std::shared_ptr<const Probe> own) {
  Calibration calibration;
  if (own) {
    const std::string changed = say_changed(root, *own);
    if (!changed.empty()) calibration.notes.push_back(changed);
  }
  calibration.options = read_options(root.at("options"));
  calibration.probe =
      own ? std::move(own) : read_probe(root.at("model").get<std::string>(), root.at("options"));
  if (root.contains("joint")) read_joint(root.at("joint"), calibration);
  calibration.flight = read_inputs(root.at("inputs"));
  calibration.fit = read_fit(root, calibration.options, output_names(*calibration.probe));
  for (const Variable& parameter : lasting_parameters(*calibration.probe)) {
    calibration.fit[parameter.name];
  }
  calibration.fit.rows = calibration.flight.rows_used;
  calibration.derived = read_derived(root.at("derived"));
  if (root.contains("restated")) calibration.restated = read_restated(root.at("restated"));
  if (root.contains("driver_ranges")) {
    calibration.driver_ranges = read_ranges(root.at("driver_ranges"));
  }
  calibration.history = read_history(root.at("history"));
  check_effects(calibration);
  return calibration;
}

Calibration read_or_refuse(Json& root, const std::string& source,
                           std::shared_ptr<const Probe> own) {
  const std::string before = source + " is damaged: ";
  const std::string after = "; fit the flight again";
  try {
    convert_earlier(root);
    return read(root, std::move(own));
  } catch (const Json::exception&) {
    throw Error(before + "a calibration's entries are missing or of another kind" + after);
  } catch (const Error& error) {
    throw_within(before, error, after);
  }
}

}  // namespace

std::string to_json(const Calibration& calibration) {
  Json root = Json::object();
  root["schema_version"] = schema_version;
  root["model"] = calibration.probe->name();
  if (calibration.probe->predicts()) {
    root["tables"] = write_tables(*calibration.probe);
  }
  if (const ModelSource* source = calibration.probe->source()) {
    root["source"] = {{"model", source->name}, {"sha256", source->sha256}};
  }
  if (const TrajectoryOptions* along = calibration.probe->trajectory()) {
    root["trajectory"] = write_trajectory(*along);
  }
  root["inputs"] = write_inputs(calibration.flight);
  if (joint_setup(*calibration.probe) != nullptr) root["joint"] = write_joint(calibration);
  root["options"] = write_options(calibration);
  write_estimates(calibration.fit, root);
  root["derived"] = write_by_name(calibration.derived, &Derived::name);
  if (!calibration.restated.empty()) root["restated"] = write_restated(calibration.restated);
  if (!calibration.driver_ranges.empty()) {
    root["driver_ranges"] = write_ranges(calibration.driver_ranges);
  }
  write_rest(calibration.fit, calibration.options.fit, root);
  root["history"] = write_list(calibration.history);
  return text_of(root);
}

namespace {

Calibration parse(std::string_view json, const std::string& source,
                  std::shared_ptr<const Probe> own) {
  Json root = files::parse_json(json, source);
  if (root.is_discarded() || !root.is_object() || !root.contains("schema_version") ||
      !root.contains("model") || !root["model"].is_string()) {
    throw Error(fmt::format("{} is not a calibration; give the JSON that fit wrote with -o{}",
                            source, json.empty() ? " (it is empty)" : ""));
  }
  if (root.contains("aircraft")) {
    throw Error(source + " is a fit of an aircraft; use sepcal-aircraft for it");
  }
  check_version(root["schema_version"], 1, source);
  const std::string model = root["model"].get<std::string>();
  if (own && model != own->name()) {
    throw Error(fmt::format("{}: its model is '{}', and the one given is '{}'; give its own",
                            source, model, own->name()));
  }
  if (own && own->trajectory() != nullptr && root.contains("trajectory")) {
    check_trajectory(root["trajectory"], *own->trajectory(), source);
  }
  if (own && root.contains("tables") && root["tables"] != write_tables(*own)) {
    throw Error(fmt::format(
        "{}: the names or units in the tables of {} have changed since it was fitted; give the "
        "model as it was, with its outputs, or fit the flight again",
        source, model));
  }
  if (!own && !catalogue::effect_tables().contains(model)) {
    const bool is_known = root.contains("source") && root["source"].contains("model") &&
                          root["source"]["model"].is_string();
    const std::string named = is_known ? root["source"]["model"].get<std::string>() : "";
    throw Error(fmt::format(
        "{}: its model, '{}', is no probe of sepcal's; give it: {} VERB --model {}, or "
        "sepcal.load(file, model=...)",
        source, model, own_app, is_known ? base::file_in_shell(named) : "FILE.py:CLASS"));
  }
  return read_or_refuse(root, source, std::move(own));
}

Calibration read_file(const std::string& file,
                      const std::function<Calibration(const std::string& text)>& parse_text) {
  Calibration calibration = parse_text(
      files::read_text_file(file, "as a calibration; give the JSON that fit wrote with -o"));
  calibration.file = file;
  return calibration;
}

}  // namespace

Calibration parse_calibration(std::string_view json, const std::string& source,
                              std::shared_ptr<const Probe> own) {
  return parse(json, source, std::move(own));
}

Calibration parse_calibration(std::string_view json, const std::string& source,
                              std::string_view app) {
  Calibration calibration = parse(json, source, nullptr);
  if (!app.empty() && calibration.probe->app() != app) {
    throw Error(fmt::format("{}: its model is '{}'; use {} for it", source,
                            calibration.probe->name(), calibration.probe->app()));
  }
  return calibration;
}

Calibration read_calibration(const std::string& file, std::string_view app) {
  return read_file(file,
                   [&](const std::string& text) { return parse_calibration(text, file, app); });
}

Calibration read_calibration(const std::string& file, std::shared_ptr<const Probe> own) {
  return read_file(file, [&](const std::string& text) { return parse(text, file, own); });
}

}  // namespace sepcal
