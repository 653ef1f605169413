// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/output_values.hpp"

namespace sepcal::json {

Json by_name(const std::vector<OutputValue>& values) {
  Json object = Json::object();
  for (const OutputValue& value : values) object[value.name] = number(value.value);
  return object;
}

double number_at(const Json& object, const char* key) {
  return object.contains(key) ? number_or(object.at(key), not_a_number) : not_a_number;
}

std::vector<OutputValue> values_by_name(const std::vector<std::string>& names, const Json& object) {
  std::vector<OutputValue> values;
  for (const std::string& name : names) {
    values.push_back({name, number_or(object.at(name), std::numeric_limits<double>::quiet_NaN())});
  }
  return values;
}

}  // namespace sepcal::json
