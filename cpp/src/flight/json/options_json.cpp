// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/options_json.hpp"

#include <concepts>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "base/thread_pool.hpp"
#include "flight/schema/option_fields.hpp"
#include "sepcal/detail/states/trajectory_options.hpp"
#include "sepcal/error.hpp"

namespace sepcal::json {
namespace {

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

// --- a value, by its type

Json write(double value) { return value; }
Json write(const std::string& value) { return value; }
Json write(const std::vector<std::string>& value) { return value; }
Json write(const std::map<std::string, double>& value) { return value; }
Json write(const std::map<std::string, std::string>& value) { return value; }
Json write(std::optional<double> value) { return value ? Json(*value) : Json(); }
template <std::integral Value>
Json write(Value value) {
  return value;
}
template <NamedChoice Choice>
Json write(Choice value) {
  return to_string(value);
}
/// {name: [lower, upper]}, null where it is open.
Json write(const std::map<std::string, Interval>& intervals) {
  Json object = Json::object();
  for (const auto& [name, ends] : intervals)
    object[name] = {number(ends.lower), number(ends.upper)};
  return object;
}
/// {name: [mean, standard deviation]}.
Json write(const std::map<std::string, Normal>& normals) {
  Json object = Json::object();
  for (const auto& [name, normal] : normals) {
    object[name] = {normal.mean, normal.standard_deviation};
  }
  return object;
}
Json write(const std::optional<Screens>& screens) {
  if (!screens) return {};
  return {{"t_1", number(screens->t_1)},
          {"t_2", number(screens->t_2)},
          {"l_2", screens->l_2},
          {"convex", screens->convex}};
}
Json write(const std::vector<EffectSetting>& settings) {
  Json list = Json::array();
  for (const EffectSetting& setting : settings) list.push_back(write_effect(setting));
  return list;
}

template <class Value>
void read(const Json& object, const std::string& /*name*/, Value& value) {
  value = object.get<Value>();
}
void read(const Json& object, const std::string& /*name*/, std::optional<double>& value) {
  value = object.get<double>();
}
template <std::integral Value>
  requires(!std::same_as<Value, bool>)
void read(const Json& object, const std::string& /*name*/, Value& value) {
  value = whole_number<Value>(object);
}
template <NamedChoice Choice>
void read(const Json& object, const std::string& name, Choice& value) {
  value = choice_of<Choice>(name, object.get<std::string>());
}
void read(const Json& object, const std::string& /*name*/,
          std::map<std::string, Interval>& intervals) {
  for (const auto& [name, ends] : entries_of(object)) {
    intervals[name] = {number_or(ends.at(0), -infinity), number_or(ends.at(1), infinity)};
  }
}
void read(const Json& object, const std::string& /*name*/, std::map<std::string, Normal>& normals) {
  for (const auto& [name, normal] : entries_of(object)) {
    normals[name] = {normal.at(0).get<double>(), normal.at(1).get<double>()};
  }
}
void read(const Json& object, const std::string& /*name*/, std::optional<Screens>& screens) {
  screens = {.t_1 = number_or(object.at("t_1"), infinity),
             .t_2 = number_or(object.at("t_2"), infinity),
             .l_2 = object.at("l_2").get<double>(),
             .convex = object.at("convex").get<bool>()};
}
void read(const Json& object, const std::string& /*name*/, std::vector<EffectSetting>& settings) {
  for (const Json& setting : elements_of(object)) settings.push_back(read_effect(setting));
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
  Json options = Json::object();
  schema::each_option([&](const auto& field) {
    if (field.is_in_file(chosen)) options[std::string(field.name)] = write(field.in(chosen));
  });
  return options;
}

CalibrationOptions read_options(const Json& options) {
  CalibrationOptions result;
  schema::each_option([&](const auto& field) {
    const std::string name(field.name);
    const bool may_lack = field.about.in_file != schema::InFile::always;
    if (may_lack && !options.contains(name)) return;
    read(options.at(name), name, field.in(result));
  });
  const int threads = result.fit.threads;
  if (threads < 0 || threads > base::most_threads) {
    throw Error(describe(options.at("threads")) + " threads are none that can be had");
  }
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
    if (settings[name].empty() && std::string_view(name) == "field_strength") {
      throw Error(describe(value) + " stands where the field's strength should");
    }
  }
  return make_probe(model, settings);
}

}  // namespace sepcal::json
