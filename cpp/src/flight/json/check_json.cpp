// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/result_json.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/check.hpp"

namespace sepcal {

using namespace json;  // this room's own

namespace {

Json write_columns(const std::vector<ColumnCheck>& columns) {
  Json list = Json::array();
  for (const ColumnCheck& column : columns) {
    list.push_back({{"column", column.header},
                    {"quantity", column.quantity},
                    {"missing", column.missing},
                    {"least", number(column.least)},
                    {"median", number(column.median)},
                    {"largest", number(column.largest)},
                    {"step", number(column.step)},
                    {"repeated", number(column.repeated)},
                    {"rate", number(column.rate)}});
  }
  return list;
}

}  // namespace

std::string to_json(const FlightCheck& check) {
  Json root = Json::object();
  root["schema_version"] = schema_version;
  root["model"] = check.model;
  root["inputs"] = {{"file", check.file},
                    {"sha256", check.sha256},
                    {"rows", check.rows},
                    {"rows_used", check.rows_used}};
  root["refused"] = check.refused.empty() ? Json() : Json(check.refused);
  root["duration"] = number(check.duration);
  root["rate"] = number(check.rate);
  root["segments"] = check.segments;
  root["columns"] = write_columns(check.columns);
  root["notes"] = write_list(check.notes);
  return text_of(root);
}

}  // namespace sepcal
