// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/truth.hpp"

#include <fmt/format.h>

#include <functional>

#include "json_values.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Noise = std::array<double, 3>;

Json write_noise(const std::array<const char*, 3>& outputs, const Noise& noise) {
  Json object = Json::object();
  for (std::size_t j = 0; j < 3; ++j) object[outputs[j]] = noise[j];
  return object;
}

void read_noise(const std::array<const char*, 3>& outputs, const Json& object, Noise& noise) {
  for (const auto& [name, value] : object.items()) {
    const auto at =
        std::ranges::find_if(outputs, [&](const char* output) { return name == output; });
    if (at == outputs.end()) throw Error("there is no output '" + name + "'");
    noise[static_cast<std::size_t>(at - outputs.begin())] = value.get<double>();
  }
}

void read_parameters(const Json& object, std::map<std::string, double>& parameters) {
  for (const auto& [name, value] : object.items()) {
    if (!parameters.contains(name)) {
      std::string known;
      for (const auto& entry : parameters) known += (known.empty() ? "" : ", ") + entry.first;
      throw Error("there is no parameter '" + name + "'; the model has: " + known);
    }
    parameters[name] = value.get<double>();
  }
}

/// Reads the entries that `read_entry` knows; messages open with `source`.
void read_object(std::string_view json, const std::string& source, std::string_view model,
                 const std::function<bool(const std::string&, const Json&)>& read_entry) {
  const Json root = Json::parse(json, nullptr, false);
  if (root.is_discarded() || !root.is_object()) {
    throw Error(source +
                " is not a truth file; give a JSON object {\"parameters\": {name: value}}");
  }
  try {
    for (const auto& [key, value] : root.items()) {
      if (key == "model") {
        if (value != model)
          throw Error("it is for the model " + value.dump() + "; use the other app");
      } else if (!read_entry(key, value)) {
        throw Error("'" + key + "' is unknown; known: model, parameters, options, noise");
      }
    }
  } catch (const Json::exception&) {
    throw Error(source +
                ": a value is not of the kind that it should be; see `simulate --truth` of "
                "a file that isn't there for an example");
  } catch (const Error& error) {
    throw Error(source + ": " + error.what());
  }
}

constexpr std::array velocities{"vn", "ve", "vd"};
constexpr std::array axes{"mx", "my", "mz"};

}  // namespace

std::string to_json(const FiveHoleTruth& truth) {
  Json root;
  root["model"] = "five-hole";
  root["parameters"] = truth.parameters;
  root["options"] = {
      {"k_alpha", truth.k_alpha}, {"k_beta", truth.k_beta}, {"lever_arm", truth.lever_arm}};
  root["noise"] = write_noise(velocities, truth.noise);
  return text_of(root);
}

std::string to_json(const MagnetometerTruth& truth) {
  Json root;
  root["model"] = "magnetometer";
  root["parameters"] = truth.parameters;
  root["options"] = {{"field", truth.field}};
  root["noise"] = write_noise(axes, truth.noise);
  return text_of(root);
}

FiveHoleTruth parse_five_hole_truth(std::string_view json, const std::string& source) {
  FiveHoleTruth truth;
  read_object(json, source, "five-hole", [&](const std::string& key, const Json& value) {
    if (key == "parameters") {
      read_parameters(value, truth.parameters);
    } else if (key == "options") {
      truth.k_alpha = value.value("k_alpha", truth.k_alpha);
      truth.k_beta = value.value("k_beta", truth.k_beta);
      truth.lever_arm = value.value("lever_arm", truth.lever_arm);
    } else if (key == "noise") {
      read_noise(velocities, value, truth.noise);
    } else {
      return false;
    }
    return true;
  });
  return truth;
}

MagnetometerTruth parse_magnetometer_truth(std::string_view json, const std::string& source) {
  MagnetometerTruth truth;
  read_object(json, source, "magnetometer", [&](const std::string& key, const Json& value) {
    if (key == "parameters") {
      read_parameters(value, truth.parameters);
    } else if (key == "options") {
      truth.field = value.value("field", truth.field);
    } else if (key == "noise") {
      read_noise(axes, value, truth.noise);
    } else {
      return false;
    }
    return true;
  });
  return truth;
}

}  // namespace sepcal
