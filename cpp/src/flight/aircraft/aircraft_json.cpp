// SPDX-License-Identifier: BSD-3-Clause
// Fits of an aircraft on disc.
#include <fmt/format.h>

#include "flight/aircraft/aircraft_effects.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/files/text_file.hpp"
#include "flight/json/earlier_versions.hpp"
#include "flight/json/fit_json.hpp"
#include "flight/json/options_json.hpp"
#include "flight/json/stepwise_json.hpp"
#include "sepcal/detail/flight/aircraft_file.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal {

using namespace json;          // what results of sensors have in common with these
using namespace aircraft_log;  // this room's own

namespace {

Json write_equations(const std::vector<AeroEquation>& equations) {
  Json object = Json::object();
  for (const AeroEquation& equation : equations) object[equation.coefficient] = equation.regressors;
  return object;
}

std::vector<AeroEquation> read_equations(const Json& object) {
  std::vector<AeroEquation> equations;
  for (const auto& [coefficient, regressors] : entries_of(object)) {
    equations.push_back({coefficient, regressors.get<std::vector<std::string>>()});
  }
  return equations;
}

Json write_model(const AircraftOptions& options) {
  Json object = {{"equations", write_equations(options.equations)}};
  object.update(write_trajectory(options.trajectory));
  if (options.position) object["position"] = true;
  object["gravity"] = options.gravity;
  object["window"] = options.window;
  if (options.band) {
    object["band"] = {{"low", options.band->low},
                      {"high", options.band->high},
                      {"spacing", options.band->spacing}};
  }
  if (options.geometry) object["geometry"] = Json::parse(to_json(*options.geometry));
  return object;
}

void read_model(const Json& object, AircraftOptions& options) {
  TrajectoryOptions& along = options.trajectory;
  options.equations = read_equations(object.at("equations"));
  along.inputs = object.at("inputs_between_rows") == "hold" ? InputsBetweenRows::hold
                                                            : InputsBetweenRows::linear;
  along.substeps = whole_number<int>(object.at("substeps"));
  along.shoot = number_or(object.at("shoot"), infinity);
  along.measured = object.at("measured").get<std::vector<std::string>>();
  along.outputs = object.at("outputs").get<std::vector<std::string>>();
  along.scales_about_start = object.at("scales_about_start").get<bool>();
  options.position = object.value("position", false);
  options.gravity = object.at("gravity").get<double>();
  options.window = object.at("window").get<double>();
  if (object.contains("band")) {
    const Json& band = object.at("band");
    options.band = Band{band.at("low").get<double>(), band.at("high").get<double>(),
                        band.at("spacing").get<double>()};
    check_band(*options.band);
  }
  if (object.contains("geometry")) {
    options.geometry = parse_aircraft(object.at("geometry").dump(), "geometry");
  }
}

Json write_fitted(const AircraftFit& fitted) {
  Json root = Json::object();
  root["schema_version"] = schema_version;
  root["model"] = to_string(fitted.options.model);
  root["method"] = method_of(fitted);
  if (fitted.options.geometry) {
    root["rate_reference"] = to_string(fitted.options.geometry->rate_reference);
  }
  root["inputs"] = write_inputs(fitted.flight);
  root["aircraft"] = write_model(fitted.options);
  root["options"] = write_options(fitted.options.calibration);
  root["equations"] = write_equations(fitted.equations);
  root["initial_states"] = fitted.initial_states;
  root["warning"] = fitted.warning;
  root["notes"] = fitted.notes;
  write_estimates(fitted.fit, root);
  write_rest(fitted.fit, fitted.options.calibration.fit, root);
  root["history"] = Json::array();
  for (const AddedRegressor& added : fitted.history) {
    root["history"].push_back({{"effect", added.effect},
                               {"rmse_before", by_name(added.rmse_before)},
                               {"rmse_after", by_name(added.rmse_after)},
                               {"predicted_drop", number(added.predicted_drop)},
                               {"drop", number(added.drop())}});
  }
  return root;
}

AircraftFit read_fitted(const Json& root) {
  AircraftFit fitted;
  fitted.options.model = find_aircraft_model(root.at("model").get<std::string>());
  fitted.options.calibration = read_options(root.at("options"));
  read_model(root.at("aircraft"), fitted.options);
  fitted.flight = read_inputs(root.at("inputs"));
  fitted.equations = read_equations(root.at("equations"));
  fitted.initial_states = root.at("initial_states").get<std::vector<std::string>>();
  fitted.warning = root.at("warning").get<std::string>();
  if (root.contains("notes")) fitted.notes = root.at("notes").get<std::vector<std::string>>();
  std::vector<std::string> outputs;
  for (const auto& [name, rmse] : entries_of(root.at("rmse"))) outputs.push_back(name);
  fitted.fit = read_fit(root, fitted.options.calibration, outputs);
  fitted.fit.rows = fitted.flight.rows_used;
  for (const Json& added : elements_of(root.at("history"))) {
    fitted.history.push_back(
        {added.at("effect").get<std::string>(), values_by_name(outputs, added.at("rmse_before")),
         values_by_name(outputs, added.at("rmse_after")), number_at(added, "predicted_drop")});
  }
  return fitted;
}

bool has_two_steps(const Json& root) {
  return root.is_object() && root.contains("path") && root.contains("aero");
}

}  // namespace

std::string to_json(const AircraftFit& fitted) { return text_of(write_fitted(fitted)); }

std::string to_json(const StepwiseAircraft& result) {
  Json root = write_fitted(result.fitted);
  root["stepwise"] = write_stepwise(result.course);
  return text_of(root);
}

std::string to_json(const TwoStepFit& fitted) {
  return text_of({{"schema_version", schema_version},
                  {"method", "two-step"},
                  {"path", write_fitted(fitted.path)},
                  {"aero", write_fitted(fitted.aero)}});
}

std::string to_json(const Applied& applied, const AircraftFit& fitted) {
  return text_of({{"schema_version", schema_version},
                  {"model", to_string(fitted.options.model)},
                  {"output", applied.output},
                  {"rows", applied.rows},
                  {"rows_left_empty", applied.rows_left_empty},
                  {"columns", applied.headers},
                  {"status", to_string(fitted.fit.status)},
                  {"message", fitted.fit.message}});
}

AircraftFit parse_aircraft_fit(std::string_view json, const std::string& source) {
  Json root = files::parse_json(json, source);
  if (root.is_discarded() || !root.is_object() || !root.contains("schema_version")) {
    throw Error(fmt::format("{} is no fit of an aircraft; give the JSON that fit wrote with -o{}",
                            source, json.empty() ? " (it is empty)" : ""));
  }
  if (has_two_steps(root)) {
    throw Error(fmt::format(
        "{} holds two steps, a path and its aerodynamics, which track alone goes on with; fit one "
        "of them alone, with --model path or --model aero",
        source));
  }
  if (!root.contains("aircraft")) {
    throw Error(fmt::format(
        "{} is a calibration of a sensor; use sepcal-pitot or sepcal-mag for it", source));
  }
  check_version(root["schema_version"], 2, source);
  try {
    convert_earlier(root);
    return read_fitted(root);
  } catch (const Json::exception&) {
    throw Error(source +
                " is damaged: entries are missing or of another kind; fit the flight again");
  } catch (const Error& error) {
    throw_within(source + " is damaged: ", error, "; fit the flight again");
  }
}

std::optional<TwoStepFit> read_two_step_fit(const std::string& file) {
  const std::string text =
      files::read_text_file(file, "as a fit; give the JSON that two-step wrote with -o");
  const Json root = files::parse_json(text, file);
  if (!has_two_steps(root)) return std::nullopt;
  return TwoStepFit{.path = parse_aircraft_fit(root.at("path").dump(), file),
                    .aero = parse_aircraft_fit(root.at("aero").dump(), file)};
}

AircraftFit read_aircraft_fit(const std::string& file) {
  const std::string text =
      files::read_text_file(file, "as a fit; give the JSON that fit wrote with -o");
  AircraftFit fitted = parse_aircraft_fit(text, file);
  fitted.file = file;
  return fitted;
}

std::string aircraft_effects_json() {
  Json tried = Json::object();
  for (const std::string_view coefficient : coefficient_names) {
    tried[std::string(coefficient)] = usual_regressors(std::string(coefficient));
  }
  return text_of({{"schema_version", schema_version},
                  {"equations", write_equations(standard_equations())},
                  {"tried_by_diagnose", tried}});
}

}  // namespace sepcal
