// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/output_values.hpp"
#include "sepcal/flight/apply.hpp"

namespace sepcal {

using namespace json;  // this room's own

std::string to_json(const Applied& applied, const Calibration& calibration) {
  const Json root{{"schema_version", schema_version},
                  {"model", calibration.probe->name()},
                  {"output", applied.output},
                  {"rows", applied.rows},
                  {"rows_left_empty", applied.rows_left_empty},
                  {"columns", applied.headers},
                  {"status", to_string(calibration.fit.status)},
                  {"message", calibration.fit.message}};
  return text_of(root);
}

}  // namespace sepcal
