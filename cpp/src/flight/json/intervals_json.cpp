// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/output_values.hpp"
#include "sepcal/flight/intervals.hpp"

namespace sepcal {

using namespace json;  // this room's own

namespace {

Json ends_of(const Interval& interval) {
  return Json::array({number(interval.lower), number(interval.upper)});
}

Json write_intervals(const std::vector<ProfileInterval>& intervals) {
  Json parameters = Json::object();
  for (const ProfileInterval& interval : intervals) {
    parameters[interval.name] = {
        {"value", number(interval.value)},
        {"unit", interval.unit},
        {"gaussian", ends_of(interval.gaussian)},
        {"profile", ends_of(interval.profile)},
        {"ends", Json::array({to_string(interval.lower_end), to_string(interval.upper_end)})},
        {"message", interval.message}};
  }
  return parameters;
}

}  // namespace

std::string to_json(const FlightIntervals& intervals) {
  const FittedFlight& flight = intervals.flight;
  const Json root{{"schema_version", schema_version},
                  {"model", intervals.model},
                  {"inputs",
                   {{"file", flight.file},
                    {"sha256", flight.sha256},
                    {"rows", flight.rows},
                    {"rows_used", flight.rows_used}}},
                  {"status", to_string(intervals.status)},
                  {"message", intervals.message},
                  {"level", intervals.level},
                  {"parameters", write_intervals(intervals.parameters)}};
  return text_of(root);
}

std::string to_json(const std::vector<ProfileInterval>& parameters, double level) {
  const Json root{{"schema_version", schema_version},
                  {"level", level},
                  {"parameters", write_intervals(parameters)}};
  return text_of(root);
}

}  // namespace sepcal
