// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/findings_json.hpp"

#include "flight/files/invalid_cells.hpp"
#include "flight/json/result_json.hpp"
#include "sepcal/error.hpp"

namespace sepcal::json {

std::vector<Derived> read_derived(const Json& object) {
  std::vector<Derived> derived;
  for (const auto& [name, entry] : entries_of(object)) {
    derived.push_back(read_fields<Derived>(entry));
    derived.back().name = name;
  }
  return derived;
}

/// {name: {sentence, number or list by name}}.
Json write_restated(const std::vector<Restatement>& restated) {
  Json object = Json::object();
  for (const Restatement& one : restated) {
    Json entry = {{"sentence", one.sentence}};
    for (const auto& [name, values] : one.numbers) {
      entry[name] = values.size() == 1 ? Json(values.front()) : Json(values);
    }
    object[one.name] = std::move(entry);
  }
  return object;
}

std::vector<Restatement> read_restated(const Json& object) {
  std::vector<Restatement> restated;
  for (const auto& [name, entry] : entries_of(object)) {
    Restatement one{.name = name, .sentence = {}, .numbers = {}};
    for (const auto& [key, value] : entries_of(entry)) {
      if (key == "sentence") {
        one.sentence = value.get<std::string>();
      } else {
        one.numbers[key] = value.is_array() ? value.get<std::vector<double>>()
                                            : std::vector<double>{value.get<double>()};
      }
    }
    restated.push_back(std::move(one));
  }
  return restated;
}

/// {channel: [least, greatest]}.
Json write_ranges(const std::map<std::string, Interval>& ranges) {
  Json object = Json::object();
  for (const auto& [channel, range] : ranges) object[channel] = {range.lower, range.upper};
  return object;
}

std::map<std::string, Interval> read_ranges(const Json& object) {
  std::map<std::string, Interval> ranges;
  for (const auto& [channel, range] : entries_of(object)) {
    const Interval read{range.at(0).get<double>(), range.at(1).get<double>()};
    if (range.size() != 2 || !files::is_reading(read.lower) || !files::is_reading(read.upper)) {
      throw Error("the range of the driver " + channel + " is not two numbers within 1e150");
    }
    if (!(read.lower <= read.upper)) {
      throw Error("the range of the driver " + channel + " ends before it begins");
    }
    ranges[channel] = read;
  }
  return ranges;
}

std::vector<HistoryEntry> read_history(const Json& list) {
  std::vector<HistoryEntry> history;
  for (const Json& entry : elements_of(list)) history.push_back(read_fields<HistoryEntry>(entry));
  return history;
}

Json write_combinations(const std::vector<Combination>& combinations) {
  Json list = Json::array();
  for (const Combination& combination : combinations) {
    list.push_back({{"combination", combination.text},
                    {"parameters", combination.parameters},
                    {"standard_error", number(combination.standard_error)}});
  }
  return list;
}

std::vector<Combination> read_combinations(const Json& list) {
  std::vector<Combination> combinations;
  for (const Json& entry : elements_of(list)) {
    combinations.push_back({entry.at("parameters").get<std::vector<std::string>>(),
                            entry.at("combination").get<std::string>(),
                            number_or(entry.at("standard_error"), infinity)});
  }
  return combinations;
}

}  // namespace sepcal::json
