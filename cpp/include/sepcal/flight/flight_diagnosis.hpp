// SPDX-License-Identifier: BSD-3-Clause
// A calibration against a flight: which physical effect is missing, and what this flight could have
// shown at all.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/flight/sized_effect.hpp"
#include "sepcal/diagnosis.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal {

/// An effect that was put into the measurements, to see whether it would have been found.
struct Injection {
  std::string effect;
  std::vector<double> sizes;  // of its coefficients
  bool found = false;         // itself or what would do as well
  std::size_t rank = 0;       // from 1, the first where it would do as well; 0: not seen
  double p_adjusted = 1.0;
  std::vector<Coefficient> estimate;
};

struct FlightDiagnosis {
  std::string model;
  std::string app;                              // that adds what is missing: "sepcal-pitot"
  std::string calibration;                      // its file; empty where it has none yet
  FittedFlight flight;                          // the flight diagnosed, not the one fitted
  FitStatus status = FitStatus::not_converged;  // of the calibration, repeated
  std::string message;
  Diagnosis diagnosis;
  std::vector<std::string> sentences;  // one an effect, in plain words
  std::vector<Misfit> where;
  std::vector<std::string> missing_channels;  // not logged, and could explain what is left
  std::optional<Injection> injection;
  std::vector<std::string> notes;  // for people; not part of the JSON
};

/// Tries every effect of the probe's catalogue, every port with every unused channel, and `own`
/// effects of the caller's. Throws Error for bad input, as calibrate() does.
FlightDiagnosis diagnose(const Calibration& calibration, const Flight& flight,
                         const OwnEffects& own = {}, const DiagnosisOptions& options = {});

/// Puts an effect into the flight's measurements, fits again from the calibration's estimates and
/// diagnoses that. Throws Error also for an effect that the flight can't make, one that the
/// calibration has, and another number of sizes than one or the effect's coefficients.
FlightDiagnosis diagnose_with(const SizedEffect& injected, const Calibration& calibration,
                              const Flight& flight, const OwnEffects& own = {},
                              const DiagnosisOptions& options = {});

/// The verdict in one sentence: what error is left, the noise's floor, the strongest cause.
std::string verdict_sentence(const FlightDiagnosis& diagnosis);

/// "found", "slow change", "undecided", "not seen", "can't be seen"; of what is not seen "not held
/// out" and "too small" where it is sure, yet refused.
std::string_view status_in_words(const EffectFinding& effect);

/// "as good instead", "fades", "counts too"; empty where it was not tried.
std::string_view beside_in_words(const EffectFinding& effect);

/// "common cause, not logged: in mx and mz together, strongest from 40 to 52 s, at 0.35 Hz".
std::string describe(const UnmeasuredCause& cause);

/// The JSON object of interface.md's `diagnose`.
std::string to_json(const FlightDiagnosis& diagnosis);

/// The page that the apps print: the verdict, the ranked effects, and what to do next.
std::string to_text(const FlightDiagnosis& diagnosis, Detail detail = Detail::brief);

}  // namespace sepcal
