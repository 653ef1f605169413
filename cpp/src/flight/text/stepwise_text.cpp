// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/page.hpp"
#include "flight/text/number_text.hpp"
#include "flight/text/pages.hpp"
#include "flight/verbs/stepwise_loop.hpp"
#include "sepcal/flight/stepwise.hpp"

namespace sepcal {

using base::joined;
using base::Page;
using base::page;

namespace {

Page signed_percent(double fraction) {
  return std::isnan(fraction) ? Page("-") : page("{:+.1f} %", 100.0 * fraction);
}

}  // namespace

Page text::course_page(const Stepwise& course) {
  std::size_t width = 6;
  for (const StepwiseStep& step : course.steps) {
    width = std::max(width, step.promised.name.size() + 2);
  }
  Page text;
  if (!course.steps.empty()) {
    text = page("{:<{}} {:>9} {:>9} {:>8} {:>9} {:>9} {:>9}  RMSE\n", "added", width, "p", "F",
                "R^2", "held out", "promised", "found");
  }
  for (const StepwiseStep& step : course.steps) {
    const EffectFinding& promised = step.promised;
    text += page("+ {:<{}} {:>9} {:>9} {:>8} {:>9} {:>9} {:>9}  {:.4g} -> {:.4g}\n", promised.name,
                 width - 2, defined(promised.p_adjusted, "{:.2g}"),
                 defined(promised.structure.partial_f, "{:.4g}"),
                 defined(promised.structure.r_squared, "{:.4f}"),
                 signed_percent(-promised.held_out_gain), signed_percent(-promised.predicted_drop),
                 signed_percent(-step.found_drop()), step.rmse_before, step.rmse_after);
    if (!step.as_good.empty()) {
      text += page("  in its place {} would do as well\n", joined(step.as_good, " or "));
    }
    for (const std::string& name : step.dropped) {
      text += page("- {}: beside {} it counts no more, and is dropped\n", name, promised.name);
    }
  }
  const std::size_t count = verbs::list_kept(course).size();
  return text +
         page("{} added; stopped as {}\n{}\n",
              count == 0 ? Page("nothing") : page("{} effect{}", count, count == 1 ? "" : "s"),
              course.reason, verdict_sentence(course.last));
}

std::string to_text(const Stepwise& course) { return text::course_page(course).text(); }

std::string to_text(const StepwiseCalibration& result, Detail detail) {
  return (text::course_page(result.course) + "\n" +
          text::calibration_page(result.calibration, detail))
      .text();
}

}  // namespace sepcal
