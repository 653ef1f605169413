// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/simulation/truth.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ranges>
#include <span>
#include <vector>

#include "flight/files/json_values.hpp"
#include "sepcal/detail/flight/aircraft_file.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Outputs = std::span<const char* const>;

constexpr std::array velocities{"vn", "ve", "vd"};
constexpr std::array airspeed{"airspeed"};
constexpr std::array axes{"mx", "my", "mz"};
constexpr std::array readings{"ax",   "ay",   "az",    "p",   "q",  "r",  "airspeed", "alpha",
                              "beta", "roll", "pitch", "yaw", "vn", "ve", "vd"};

/// An entry of `options`: one number, or as many as `values` has in a list.
struct Setting {
  std::string_view name;
  std::span<double> values;
};

files::Json write_noise(Outputs outputs, std::span<const double> noise) {
  files::Json object = files::Json::object();
  for (std::size_t j = 0; j < outputs.size(); ++j) object[outputs[j]] = noise[j];
  return object;
}

void read_noise(const files::Json& object, Outputs outputs, std::span<double> noise) {
  for (const auto& [name, value] : files::entries_of(object)) {
    const auto at = std::ranges::find(outputs, name);
    if (at == outputs.end()) {
      throw Error(fmt::format("there is no output '{}'; the model has: {}", name,
                              fmt::join(outputs, ", ")));
    }
    noise[static_cast<std::size_t>(at - outputs.begin())] = value.get<double>();
  }
}

files::Json write_noise(Outputs /*outputs*/, const std::map<std::string, double>& noise) {
  return noise;
}

void read_noise(const files::Json& object, Outputs outputs, std::map<std::string, double>& noise) {
  std::vector<double> values;
  for (const char* output : outputs) values.push_back(noise.at(output));
  read_noise(object, outputs, std::span<double>(values));
  for (std::size_t j = 0; j < outputs.size(); ++j) noise[outputs[j]] = values[j];
}

void read_parameters(const files::Json& object, std::map<std::string, double>& parameters) {
  for (const auto& [name, value] : files::entries_of(object)) {
    if (!parameters.contains(name) && name.find('.') == std::string::npos) {
      throw Error(fmt::format("there is no parameter '{}'; the model has: {}", name,
                              fmt::join(std::views::keys(parameters), ", ")));
    }
    parameters[name] = value.get<double>();
  }
}

void read_effects(const files::Json& list, std::vector<SizedEffect>& effects) {
  for (const files::Json& effect : files::elements_of(list)) {
    effects.push_back({.name = effect.get<std::string>()});
  }
}

void read_settings(const files::Json& object, const std::vector<Setting>& settings) {
  for (const auto& [name, value] : files::entries_of(object)) {
    const auto at = std::ranges::find(settings, name, &Setting::name);
    if (at == settings.end()) {
      throw Error(fmt::format("there is no option '{}'; known: {}", name,
                              fmt::join(settings | std::views::transform(&Setting::name), ", ")));
    }
    if (at->values.size() == 1) {
      at->values[0] = value.get<double>();
      continue;
    }
    const auto numbers = value.get<std::vector<double>>();
    if (numbers.size() != at->values.size()) {
      throw Error(
          fmt::format("{} needs {} numbers; see `simulate --truth` of a file that isn't "
                      "there for an example",
                      name, at->values.size()));
    }
    std::ranges::copy(numbers, at->values.begin());
  }
}

/// What only some truths have; false where this one doesn't.
template <class Truth>
bool read_more(const std::string& key, const files::Json& value, Truth& truth) {
  if constexpr (requires { truth.geometry; }) {
    if (key == "aircraft") truth.geometry = parse_aircraft(value.dump(), "aircraft");
    return key == "aircraft";
  }
  return false;
}

/// Reads what the object names into `truth`; the rest keeps its default.
template <class Truth>
void read_truth(std::string_view json, std::string_view model, Outputs outputs,
                const std::vector<Setting>& settings, Truth& truth) {
  const files::Json root = files::parse_json(json, truth.source);
  if (root.is_discarded() || !root.is_object()) {
    throw Error(truth.source +
                " is not a truth file; give a JSON object {\"parameters\": {name: value}}");
  }
  try {
    for (const auto& [key, value] : root.items()) {
      if (read_more(key, value, truth)) continue;
      if (key == "parameters") {
        read_parameters(value, truth.parameters);
      } else if (key == "options") {
        read_settings(value, settings);
      } else if (key == "noise") {
        read_noise(value, outputs, truth.noise);
      } else if (key == "effects") {
        read_effects(value, truth.effects);
      } else if (key != "model") {
        throw Error(
            fmt::format("'{}' is unknown; known: model, parameters, options, noise, effects", key));
      } else if (value != model) {
        throw Error(fmt::format("it is for the model {}; use the other app, or another --probe",
                                files::describe(value)));
      }
    }
  } catch (const files::Json::exception&) {
    throw Error(truth.source +
                ": a value is not of the kind that it should be; see `simulate --truth` of "
                "a file that isn't there for an example");
  } catch (const Error& error) {
    throw_within(truth.source + ": ", error);
  }
}

template <class Truth>
std::string write_truth(std::string_view model, const Truth& truth, const files::Json& options,
                        Outputs outputs) {
  files::Json root = files::Json::object();
  root["model"] = model;
  root["parameters"] = truth.parameters;
  root["options"] = options;
  root["noise"] = write_noise(outputs, truth.noise);
  for (const SizedEffect& effect : truth.effects) root["effects"].push_back(effect.name);
  return files::text_of(root);
}

}  // namespace

std::string to_json(const FiveHoleTruth& truth) {
  const files::Json options{
      {"k_alpha", truth.k_alpha}, {"k_beta", truth.k_beta}, {"lever_arm", truth.lever_arm}};
  return write_truth("five-hole", truth, options, velocities);
}

std::string to_json(const PitotStaticTruth& truth) {
  return write_truth("pitot-static", truth, files::Json::object(), airspeed);
}

std::string to_json(const MagnetometerTruth& truth) {
  return write_truth("magnetometer", truth, {{"field", truth.field}}, axes);
}

std::string to_json(const AircraftTruth& truth) {
  const files::Json options{{"airspeed", truth.airspeed},
                            {"altitude", truth.altitude},
                            {"turbulence", truth.turbulence},
                            {"gust_length", truth.gust_length},
                            {"process_noise", truth.process_noise}};
  files::Json root = files::Json::parse(write_truth("aircraft", truth, options, readings));
  root["aircraft"] = files::Json::parse(to_json(truth.geometry));
  return files::text_of(root);
}

FiveHoleTruth parse_five_hole_truth(std::string_view json, const std::string& source) {
  FiveHoleTruth truth{.source = source};
  read_truth(json, "five-hole", velocities,
             {{"k_alpha", {&truth.k_alpha, 1}},
              {"k_beta", {&truth.k_beta, 1}},
              {"lever_arm", truth.lever_arm}},
             truth);
  return truth;
}

PitotStaticTruth parse_pitot_static_truth(std::string_view json, const std::string& source) {
  PitotStaticTruth truth{.source = source};
  read_truth(json, "pitot-static", airspeed, {}, truth);
  return truth;
}

MagnetometerTruth parse_magnetometer_truth(std::string_view json, const std::string& source) {
  MagnetometerTruth truth{.source = source};
  double strength = 0.0;
  read_truth(json, "magnetometer", axes,
             {{"field", truth.field}, {"field_strength", {&strength, 1}}}, truth);
  if (strength != 0.0) {
    const double length = std::hypot(truth.field[0], truth.field[1], truth.field[2]);
    for (double& component : truth.field) component *= strength / length;
  }
  return truth;
}

AircraftTruth parse_aircraft_truth(std::string_view json, const std::string& source) {
  AircraftTruth truth{.source = source};
  read_truth(json, "aircraft", readings,
             {{"airspeed", {&truth.airspeed, 1}},
              {"altitude", {&truth.altitude, 1}},
              {"turbulence", {&truth.turbulence, 1}},
              {"gust_length", {&truth.gust_length, 1}},
              {"process_noise", {&truth.process_noise, 1}}},
             truth);
  return truth;
}

}  // namespace sepcal
