// SPDX-License-Identifier: BSD-3-Clause
// Diagnosis step by step: the effect that is advised is added, all is fitted again and asked again,
// until nothing passes. Each step's promise stands beside what came of it.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/choices.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"

namespace sepcal {

/// Why no more was added.
enum class StepwiseEnd {
  nothing_found,  // nothing passes any more
  most_added,     // as many as were asked for; more may pass
  withheld,       // of what passes nothing is to be added, as real fits have it
  fit_failed      // the next one's fit: its step is not taken
};

template <>
struct ChoiceNames<StepwiseEnd> {
  static constexpr std::array<std::string_view, 4> names{"nothing_found", "most_added", "withheld",
                                                         "fit_failed"};
};

/// An effect that was added.
struct StepwiseStep {
  EffectFinding promised;    // as the diagnosis before it had it
  double rmse_before = 0.0;  // over promised.outputs, of the rows that are fitted; 1 where these
                             // have different units: in units of each one's own
  double rmse_after = 0.0;
  std::vector<std::string> as_good = {};  // what would have done as well in its place
  std::vector<std::string> dropped = {};  // what was added before and counts no more beside it

  double found_drop() const { return 1.0 - rmse_after / rmse_before; }
};

struct Stepwise {
  std::vector<StepwiseStep> steps = {};
  StepwiseEnd end = StepwiseEnd::nothing_found;
  std::string reason = {};    // a sentence
  FlightDiagnosis last = {};  // of the last fit
};

struct StepwiseOptions {
  std::size_t most = std::numeric_limits<std::size_t>::max();  // that are added, at least 1
  DiagnosisOptions diagnosis = {};
};

struct StepwiseCalibration {
  Calibration calibration;
  Stepwise course;
};

/// From `base` on, by add() and diagnose(); of another flight than the fitted one as add() does.
/// `own`: candidates of the caller's. Throws Error as these do for the base, and for `most` 0.
StepwiseCalibration diagnose_stepwise(const Calibration& base, const Flight& flight,
                                      const OwnEffects& own = {},
                                      const StepwiseOptions& options = {});

/// The calibration's JSON with `stepwise` {steps [{effect, ...}], end, reason, verdict} joined.
std::string to_json(const StepwiseCalibration& result);

/// The steps, why they ended, and the calibration's page.
std::string to_text(const StepwiseCalibration& result, Detail detail = Detail::brief);

/// The steps as a table, and why they ended.
std::string to_text(const Stepwise& course);

}  // namespace sepcal
