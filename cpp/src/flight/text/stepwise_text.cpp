// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "flight/verbs/stepwise_loop.hpp"
#include "sepcal/flight/stepwise.hpp"

namespace sepcal {
namespace {

std::string signed_percent(double fraction) { return fmt::format("{:+.1f} %", 100.0 * fraction); }

}  // namespace

std::string to_text(const Stepwise& course) {
  std::size_t width = 6;
  for (const StepwiseStep& step : course.steps) {
    width = std::max(width, step.promised.name.size() + 2);
  }
  std::string text;
  if (!course.steps.empty()) {
    text = fmt::format("{:<{}} {:>9} {:>9} {:>9} {:>9} {:>9}  RMSE\n", "added", width, "p", "F",
                       "held out", "promised", "found");
  }
  for (const StepwiseStep& step : course.steps) {
    const EffectFinding& promised = step.promised;
    text += fmt::format("+ {:<{}} {:>9.2g} {:>9.3g} {:>9} {:>9} {:>9}  {:.4g} -> {:.4g}\n",
                        promised.name, width - 2, promised.p_adjusted, promised.structure.partial_f,
                        signed_percent(-promised.held_out_gain),
                        signed_percent(-promised.predicted_drop),
                        signed_percent(-step.found_drop()), step.rmse_before, step.rmse_after);
    if (!step.as_good.empty()) {
      text += fmt::format("  in its place {} would do as well\n", fmt::join(step.as_good, " or "));
    }
    for (const std::string& name : step.dropped) {
      text +=
          fmt::format("- {}: beside {} it counts no more, and is dropped\n", name, promised.name);
    }
  }
  const std::size_t count = verbs::list_kept(course).size();
  return text + fmt::format("{} added; stopped as {}\n{}\n",
                            count == 0 ? "nothing"
                                       : fmt::format("{} effect{}", count, count == 1 ? "" : "s"),
                            course.reason, verdict_sentence(course.last));
}

std::string to_text(const StepwiseCalibration& result, Detail detail) {
  return to_text(result.course) + "\n" + to_text(result.calibration, detail);
}

}  // namespace sepcal
