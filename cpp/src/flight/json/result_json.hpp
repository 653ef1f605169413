// SPDX-License-Identifier: BSD-3-Clause
// Results to and from JSON by their table (result_fields.hpp).
#pragma once

#include <functional>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "flight/json/output_values.hpp"
#include "flight/schema/result_fields.hpp"

namespace sepcal::json {

inline Json write_value(double value) { return number(value); }
inline Json write_value(const std::vector<OutputValue>& values) { return by_name(values); }
inline Json write_value(const std::map<std::string, double>& values) {
  Json object = Json::object();
  for (const auto& [name, value] : values) object[name] = number(value);
  return object;
}
inline Json write_value(const NoiseModel& noise) {
  const std::vector<double> phi(noise.phi.begin(), noise.phi.end());
  return {{"d", noise.d}, {"phi", phi}, {"sigma", noise.sigma}};
}
template <class Value>
Json write_value(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return to_string(value);
  } else {
    return value;
  }
}

inline double of_null(schema::Null null) {
  if (null == schema::Null::no_lower_end) return -infinity;
  return null == schema::Null::no_upper_end ? infinity : not_a_number;
}

inline void read_value(const Json& json, double& value, schema::Null null) {
  value = null == schema::Null::refused ? json.get<double>() : number_or(json, of_null(null));
}
template <class Value>
void read_value(const Json& json, Value& value, schema::Null /*null*/) {
  value = json.get<Value>();
}

/// The fields that files have, put into `object`, where what is there already keeps its place.
template <class Result>
void write_fields(const Result& result, Json& object) {
  schema::ResultFields<Result>::each([&](const char* name, const auto& member, const char*,
                                         schema::Told told = schema::Told::everywhere,
                                         schema::Null = schema::Null::not_a_number) {
    if (told != schema::Told::in_code) object[name] = write_value(std::invoke(member, result));
  });
}

template <class Result>
Json write_fields(const Result& result) {
  Json object = Json::object();
  write_fields(result, object);
  return object;
}

template <class Result>
Json write_list(const std::vector<Result>& results) {
  Json list = Json::array();
  for (const Result& result : results) list.push_back(write_fields(result));
  return list;
}

/// {name: the other fields}; `name` is the member that has it.
template <class Result>
Json write_by_name(const std::vector<Result>& results, std::string Result::* name) {
  Json object = Json::object();
  for (const Result& result : results) object[result.*name] = write_fields(result);
  return object;
}

/// What write_fields() wrote. Throws Json::exception for anything else.
template <class Result>
Result read_fields(const Json& object) {
  Result result;
  schema::ResultFields<Result>::each([&](const char* name, const auto& member, const char*,
                                         schema::Told told = schema::Told::everywhere,
                                         schema::Null null = schema::Null::not_a_number) {
    if (told == schema::Told::in_code) return;
    if (told == schema::Told::lately && !object.contains(name)) return;
    read_value(object.at(name), std::invoke(member, result), null);
  });
  return result;
}

}  // namespace sepcal::json
