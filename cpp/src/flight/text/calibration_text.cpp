// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/page.hpp"
#include "flight/text/fit_text.hpp"
#include "flight/text/pages.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal {

using base::Page;
using base::page;

namespace {

/// The chain of added effects, each with the error before and after; empty where none was added.
Page history_table(const Calibration& calibration) {
  const std::vector<HistoryEntry>& history = calibration.history;
  if (history.empty()) return "";
  const std::string unit = calibration.probe->model().tables().output_unit();
  Page text = unit.empty() ? Page("\nRMSE over all outputs, each by its own before\n")
                           : page("\nRMSE over all outputs [{}]\n", unit);
  std::size_t width = 0;
  for (const HistoryEntry& entry : history) width = std::max(width, entry.effect.size());
  for (const HistoryEntry& entry : history) {
    text += page("  + {:<{}}  {:.4g} -> {:.4g}  ({:+.1f} %", entry.effect, width, entry.rmse_before,
                 entry.rmse_after, 100.0 * (entry.rmse_after / entry.rmse_before - 1.0));
    if (std::isfinite(entry.predicted_drop)) {
      text += page(", promised {:+.1f} %", -100.0 * entry.predicted_drop);
    }
    if (std::isfinite(entry.held_out_before)) {
      text +=
          page("; on rows held out {:.4g} -> {:.4g}", entry.held_out_before, entry.held_out_after);
    }
    text += ")\n";
  }
  return text;
}

/// A line each; empty where there are none.
Page restated_lines(const Calibration& calibration) {
  Page text;
  for (const Restatement& one : calibration.restated) {
    if (text.empty()) text += "\n";
    text += page("{}: {}\n", one.name, one.sentence);
  }
  return text;
}

/// What a joint fit says of its flights; empty where there is one.
Page departure_lines(const Calibration& calibration) {
  constexpr double level = 0.01;
  std::vector<FlightDeparture> flights = calibration.departures;
  std::ranges::stable_sort(flights, {}, [](const FlightDeparture& one) {  // the surest first
    return std::isnan(one.p) ? infinity : one.p;
  });
  if (flights.empty()) return "";
  Page text = "\n";
  for (const FlightDeparture& one : flights) {
    if (!(one.p < level)) continue;
    text += page("{} departs from the other flights (p {:.2g})", one.flight, one.p);
    if (!one.parameter.empty()) {
      text += page(": {} by {:.3g} +- {:.2g}", one.parameter, one.difference, one.standard_error);
    }
    text += "\n";
  }
  if (text.text().size() > 1) return text;
  const auto least = std::ranges::min_element(
      flights, {}, [](const FlightDeparture& one) { return std::isnan(one.p) ? infinity : one.p; });
  return text + (std::isnan(least->p)
                     ? Page("no flight could be tested for its departure from the others\n")
                     : page("no flight departs from the others (least p {:.2g}: {})\n", least->p,
                            least->flight));
}

/// The fit without the parameters whose place each flight's own have taken.
Fit shown_fit(const Calibration& calibration) {
  Fit fit = calibration.fit;
  if (const JointSetup* const joint = joint_setup(*calibration.probe)) {
    std::erase_if(fit.parameters, [&](const Parameter& parameter) {
      return std::ranges::find(joint->own, parameter.name) != joint->own.end();
    });
  }
  return fit;
}

}  // namespace

Page text::calibration_page(const Calibration& calibration, Detail detail) {
  return page("{}: {} of {} rows of {}\n", calibration.probe->name(), calibration.flight.rows_used,
              calibration.flight.rows, calibration.flight.file) +
         text::fit_table(shown_fit(calibration), calibration.options, calibration.derived, detail) +
         restated_lines(calibration) + departure_lines(calibration) + history_table(calibration);
}

std::string to_text(const Calibration& calibration, Detail detail) {
  return text::calibration_page(calibration, detail).text();
}

}  // namespace sepcal
