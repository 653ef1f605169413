// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/stepwise_json.hpp"

namespace sepcal {

using namespace json;  // this room's own

Json json::write_stepwise(const Stepwise& course) {
  Json steps = Json::array();
  for (const StepwiseStep& step : course.steps) {
    const EffectFinding& promised = step.promised;
    steps.push_back({{"effect", promised.name},
                     {"outputs", promised.outputs},
                     {"p_adjusted", number(promised.p_adjusted)},
                     {"partial_f", number(promised.structure.partial_f)},
                     {"pse", number(promised.structure.pse)},
                     {"pse_without", number(promised.structure.pse_without)},
                     {"held_out_gain", number(promised.held_out_gain)},
                     {"predicted_drop", number(promised.predicted_drop)},
                     {"found_drop", number(step.found_drop())},
                     {"rmse_before", number(step.rmse_before)},
                     {"rmse_after", number(step.rmse_after)},
                     {"as_good", step.as_good},
                     {"dropped", step.dropped}});
  }
  return {{"steps", steps},
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
