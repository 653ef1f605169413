// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/stepwise_json.hpp"

#include "flight/json/result_json.hpp"

namespace sepcal {

using namespace json;  // this room's own

Json json::write_stepwise(const Stepwise& course) {
  return {{"steps", write_list(course.steps)},
          {"end", to_string(course.end)},
          {"reason", course.reason},
          {"verdict", to_string(course.last.diagnosis.verdict)},
          {"sentence", verdict_sentence(course.last)}};
}

std::string to_json(const StepwiseCalibration& result) {
  Json root = Json::parse(to_json(result.calibration));
  root["stepwise"] = write_stepwise(result.course);
  return text_of(root);
}

}  // namespace sepcal
