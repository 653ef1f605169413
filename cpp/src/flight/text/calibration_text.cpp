// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flight/text/fit_text.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal {
namespace {

/// The chain of added effects, each with the error before and after; empty where none was added.
std::string history_table(const Calibration& calibration) {
  const std::vector<HistoryEntry>& history = calibration.history;
  if (history.empty()) return "";
  const auto& outputs = calibration.probe->model().tables().outputs;
  std::string text = fmt::format("\nRMSE over all outputs [{}]\n", outputs.front().unit);
  std::size_t width = 0;
  for (const HistoryEntry& entry : history) width = std::max(width, entry.effect.size());
  for (const HistoryEntry& entry : history) {
    text += fmt::format("  + {:<{}}  {:.4g} -> {:.4g}  ({:+.1f} %", entry.effect, width,
                        entry.rmse_before, entry.rmse_after,
                        100.0 * (entry.rmse_after / entry.rmse_before - 1.0));
    if (std::isfinite(entry.predicted_drop)) {
      text += fmt::format(", promised {:+.1f} %", -100.0 * entry.predicted_drop);
    }
    if (std::isfinite(entry.held_out_before)) {
      text += fmt::format("; on rows held out {:.4g} -> {:.4g}", entry.held_out_before,
                          entry.held_out_after);
    }
    text += ")\n";
  }
  return text;
}

/// A line each; empty where there are none.
std::string restated_lines(const Calibration& calibration) {
  std::string text;
  for (const Restatement& one : calibration.restated) {
    text += fmt::format("{}{}: {}\n", text.empty() ? "\n" : "", one.name, one.sentence);
  }
  return text;
}

}  // namespace

std::string to_text(const Calibration& calibration, Detail detail) {
  return fmt::format("{}: {} of {} rows of {}\n", calibration.probe->name(),
                     calibration.flight.rows_used, calibration.flight.rows,
                     calibration.flight.file) +
         text::fit_table(calibration.fit, calibration.options, calibration.derived, detail) +
         restated_lines(calibration) + history_table(calibration);
}

}  // namespace sepcal
