// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/findings_json.hpp"

#include "flight/files/invalid_cells.hpp"
#include "sepcal/error.hpp"

namespace sepcal::json {

Json write_misfit(const Misfit& misfit) {
  return {{"segment", misfit.segment},   {"output", misfit.output},
          {"rows", misfit.rows},         {"rmse", number(misfit.rmse)},
          {"mean", number(misfit.mean)}, {"lag_one", number(misfit.lag_one)}};
}

Json write_derived(const std::vector<Derived>& derived) {
  Json object = Json::object();
  for (const Derived& quantity : derived) {
    object[quantity.name] = {
        {"value", number(quantity.value)},
        {"standard_error", number(quantity.standard_error)},
        {"standard_error_white", number(quantity.standard_error_white)},
        {"standard_error_noise_model", number(quantity.standard_error_noise_model)},
        {"standard_error_blocks", number(quantity.standard_error_blocks)},
        {"unit", quantity.unit}};
  }
  return object;
}

std::vector<Derived> read_derived(const Json& object) {
  std::vector<Derived> derived;
  for (const auto& [name, entry] : entries_of(object)) {
    derived.push_back(
        {.name = name,
         .unit = entry.at("unit").get<std::string>(),
         .value = number_or(entry.at("value"), not_a_number),
         .standard_error = number_or(entry.at("standard_error"), not_a_number),
         .standard_error_white = number_or(entry.at("standard_error_white"), not_a_number),
         .standard_error_noise_model = number_at(entry, "standard_error_noise_model"),
         .standard_error_blocks = number_at(entry, "standard_error_blocks")});
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

Json write_history(const std::vector<HistoryEntry>& history) {
  Json list = Json::array();
  for (const HistoryEntry& entry : history) {
    list.push_back({{"effect", entry.effect},
                    {"rmse_before", number(entry.rmse_before)},
                    {"rmse_after", number(entry.rmse_after)},
                    {"held_out_before", number(entry.held_out_before)},
                    {"held_out_after", number(entry.held_out_after)},
                    {"predicted_drop", number(entry.predicted_drop)}});
  }
  return list;
}

std::vector<HistoryEntry> read_history(const Json& list) {
  std::vector<HistoryEntry> history;
  for (const Json& entry : elements_of(list)) {
    history.push_back({.effect = entry.at("effect").get<std::string>(),
                       .rmse_before = number_or(entry.at("rmse_before"), not_a_number),
                       .rmse_after = number_or(entry.at("rmse_after"), not_a_number),
                       .held_out_before = number_or(entry.at("held_out_before"), not_a_number),
                       .held_out_after = number_or(entry.at("held_out_after"), not_a_number),
                       .predicted_drop = number_or(entry.at("predicted_drop"), not_a_number)});
  }
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
