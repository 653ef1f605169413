// SPDX-License-Identifier: BSD-3-Clause
// A flight brought to a probe once, for whatever a verb asks of it: a fit, the model of a
// calibration that is there already, a diagnosis.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/thread_pool.hpp"
#include "flight/verbs/mended_flight.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/diagnosis.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::verbs {

struct PreparedFlight {
  Flight flight;         // as read_as() gives it, its drivers mended
  ProbeRecord readings;  // before effects in time cut its edges
  Flight logged;         // as read_as() gives it

  // What mend() found.
  std::vector<std::string> bridged = {};
  std::vector<std::string> filled = {};
  RowsToLeave measured = {};
  RowsToLeave all = {};
  std::vector<std::string> slow = {};
  bool loss_helps = true;
};

/// Throws Error as read_as() and Probe::prepare() do.
PreparedFlight prepare(const Probe& probe, const Flight& flight, const LogChoice& log);
PreparedFlight prepare(const Calibration& calibration, const Flight& flight);

/// By which later verbs know the flight again: its file's SHA-256, and where a model has initial
/// states also that of arrays; else empty.
std::string digest(const Probe& probe, const PreparedFlight& prepared);

/// The calibration on that flight: of a model with a state along its rows, where they are not those
/// of the fit with the initial states estimated anew and all else held, which a note says; of
/// another model as it is.
Calibration along(const Calibration& given, PreparedFlight& prepared);

/// What the calibration chose of its log, as far as it means something on this flight: times are of
/// the fitted one's clock. A note says what was left out.
LogChoice choice_for(const Calibration& calibration, const Flight& flight,
                     std::vector<std::string>& notes);

/// As the model with the calibration's effects takes it; they mean what they meant on the flight
/// that was fitted. Throws Error as with_effects() does, and where the calibration's parameters are
/// not those of its model with its effects.
EffectiveFlight with_effects_of(const Calibration& calibration, const PreparedFlight& prepared);

/// z - model (rows() x n_z) in the rows of that flight's segments, at the calibration's estimates.
Eigen::MatrixXd residuals_of(const Calibration& calibration, const EffectiveFlight& effective,
                             base::ThreadPool& pool);

/// Adds what was mended to the notes of the readings.
void note_mended(PreparedFlight& prepared);

/// The base as it would be of the rows that are readings, and samples of the slowest column;
/// `prepared` is then of these. Nothing where all rows seem to be, or where these can't be fitted.
std::optional<Calibration> without_suspects(const Calibration& base, PreparedFlight& prepared,
                                            const OwnEffects& own, const FitProgress& progress);

/// What a person is told of that: what was suspected and slow before, and what is chosen now.
std::string say_left_out(const std::string& flight, const LogChoice& now,
                         const RowsToLeave& suspected, const std::vector<std::string>& slow);

/// The base as it would be of a flight's readings: fitted anew where it is of another flight, or of
/// rows that are none.
struct OnFlight {
  Calibration calibration;
  std::vector<std::string> notes;  // that say so
};
OnFlight on_readings_of(const Calibration& base, const Flight& flight, PreparedFlight& prepared,
                        const OwnEffects& own, const FitProgress& progress);

/// As the public calibrate().
Calibration calibrate(const std::shared_ptr<const Probe>& probe, const PreparedFlight& prepared,
                      const CalibrationOptions& options);

/// The base's options for a fit that begins at its estimates.
CalibrationOptions options_from(const Calibration& base, const OwnEffects& own,
                                const FitProgress& progress);

/// The base as it would be of this flight: an effect must not be praised for what a new wind
/// brings.
Calibration refit_to(const Calibration& base, const PreparedFlight& prepared, const OwnEffects& own,
                     const FitProgress& progress);

/// As the public add(), but for what is said of several flights.
Calibration add_effect(const Calibration& base, const Flight& flight, const std::string& effect,
                       const OwnEffects& own, const FitProgress& progress);

/// As the engine's diagnosis takes it. `own`: effects that the calibration or the caller made.
DiagnosedFit diagnosed_fit(const Calibration& calibration, const Record& readings,
                           const OwnEffects& own);

/// Whether the flight is another file than the calibration was fitted to.
bool is_other_flight(const Calibration& calibration, const Flight& flight);

/// Throws Error where both are known and differ.
void check_fitted(const Calibration& calibration, const Flight& flight);

/// Adds a note where the flight is another file than the calibration was fitted to: its errors are
/// no longer those of a fit.
void note_other_flight(const Calibration& calibration, const Flight& flight,
                       std::vector<std::string>& notes);

}  // namespace sepcal::verbs
