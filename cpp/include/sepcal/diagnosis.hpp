// SPDX-License-Identifier: BSD-3-Clause
// Which physical effect does a fitted model lack? Every candidate is tried at the fit, by its
// derivative at zero: screened by the score test, tested in noise of free size and in noise as
// instruments have it, judged by how much of the error falls on rows that were held out. The few
// that pass are fitted for real. docs/diagnosis.md has the statistics.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sepcal/detail/choices.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/named_effects.hpp"
#include "sepcal/detail/path_model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal {

enum class Verdict {
  adequate,        // no candidate was found, and none takes a fifth of the error
  effect_missing,  // at least one candidate was found
  slow_change,     // a slow effect, or noise that wanders: one record can't tell
  unexplained      // something is missing, and no candidate surely explains it
};

/// "adequate", "effect_missing", "slow_change", "unexplained".
std::string_view to_string(Verdict verdict);

enum class FindingStatus {
  found,          // significant after Holm's correction, and the held-out error falls
  slow_change,    // the same of a slow driver, were it known that the noise does not wander; or it
                  // takes a fifth of the held-out error by a real fit, and noise could too
  undecided,      // the same of what is not slow; or it was found, and no fit takes it
  not_seen,       // nothing of it in the residuals
  cannot_be_seen  // the record can't tell it from what the model has
};

/// "found", "slow_change", "undecided", "not_seen", "cannot_be_seen".
std::string_view to_string(FindingStatus status);

/// What becomes of an effect once the first of those found is added, by real fits.
enum class Beside {
  untried,     // nothing was found, or not this, or it is the first
  equivalent,  // added instead, it explains as much: -2 ln L within 9.2
  fades,       // once the first is added it is no longer significant, or not held out
  counts       // it is significant beside the first, and rows held out are predicted better
};

/// "untried", "equivalent", "fades", "counts".
std::string_view to_string(Beside beside);

/// A coefficient of an effect as one step from the fit estimates it, or a fit with the effect.
struct Coefficient {
  std::string name;  // "wind[altitude_m].n"
  std::string unit;
  double estimate = 0.0;
  double standard_error = 0.0;  // in the noise model with the effect, or the fit's
};

/// What bounds the noise of a predicted square error: sidpac half the variance of what is measured
/// (as SIDPAC's swr has it), classic all of it.
enum class PseBound { sidpac, classic };

template <>
struct ChoiceNames<PseBound> {
  static constexpr std::array<std::string_view, 2> names{"sidpac", "classic"};
};

/// What decides: verdict, all that diagnose() asks; partial_f, stepwise regression's partial F of
/// single candidates alone, residuals taken for white and regressors as they are read.
enum class DiagnosisRule { verdict, partial_f };

template <>
struct ChoiceNames<DiagnosisRule> {
  static constexpr std::array<std::string_view, 2> names{"verdict", "partial-f"};
};

/// From which partial F on a candidate enters by DiagnosisRule::partial_f, as SIDPAC's swr has it.
inline constexpr double enters_from = 20.0;

/// What stepwise regression asks of a candidate, residuals taken for white. Sums are over all N
/// readings, those of each output in units of its RMSE in the fit: squares of a single output times
/// rmse^2 are those of its unit. p are the model's parameters, q the candidate's that can be seen.
/// NaN where undefined.
struct Structure {
  double partial_f = not_a_number;      // sse_reduction / q over (sse - sse_reduction)/(N - p - q)
  double sse = not_a_number;            // without it
  double sse_reduction = not_a_number;  // by orthogonal functions: what it takes of sse
  double pse = not_a_number;  // predicted square error, SSE/N + 2 s2max (p + q)/N; s2max: PseBound
  double pse_without = not_a_number;
  double r_squared = not_a_number;  // of what is measured about its mean, with it
  double r_squared_without = not_a_number;
};

/// What the record says about one candidate. Undefined numbers are NaN.
struct EffectFinding {
  std::string name = {};  // what add() takes: "wind[altitude_m]", or "E1+E2"
  std::vector<std::string> drivers =
      {};  // channels; none where the effect has a physics of its own
  std::vector<Coefficient> coefficients = {};
  bool is_fitted = false;                     // they are those of a fit with the effect
  std::map<std::string, double> shapes = {};  // of a scan: "bias_step.t0", where it explains most

  double log10_p = 0.0;     // of p_value, which may be too small for a double
  double p_value = 1.0;     // for itself, corrected for its scan
  double p_adjusted = 1.0;  // after Holm: for the verdict
  double p_listed = 1.0;    // after Benjamini & Hochberg: for the list

  /// What is left of the estimates, allowing for the choice of the effect among the candidates:
  /// 1 unless it is barely found.
  double share_after_selection = 1.0;

  std::vector<std::string> outputs = {};  // of the fit, that the figures are over
  double predicted_drop = 0.0;            // of the RMSE over all of these, 1 - after / before
  bool drop_is_fitted = false;            // it is that of a real fit, of a model with a state
  double held_out_before = 0.0;           // RMSE of rows left out, over these
  double held_out_after = 0.0;            // with the effect
  double held_out_gain = 0.0;             // 1 - after / before
  bool held_out_passed = false;           // the mean gain of a block exceeds its standard error
  bool held_out_interleaved = false;      // blocks in between, not whole segments, were left out
  bool held_out_refitted = false;         // by real fits with it and without, not by one step

  /// How many times as far as instruments of the kind do errors would have to wander to look like
  /// it; infinite where they can't, NaN where it was not asked.
  double excuse = not_a_number;

  Structure structure = {};
  double visibility = 0.0;  // sine of the smallest angle to the model's own tangent
  std::map<std::string, double> absorbed_by = {};  // how far ignoring it shifts each parameter
  FindingStatus status = FindingStatus::not_seen;
  Beside beside = Beside::untried;
};

/// An output's residual. Undefined numbers are NaN.
struct ResidualNoise {
  std::string output = {};
  std::string unit = {};
  double rmse = 0.0;
  double lag_one = 0.0;      // correlation of neighbouring rows
  double ljung_box_p = 0.0;  // of 20 lags: small where the residual is not white
  NoiseModel noise = {};     // in the output's unit
  double floor = 0.0;        // sigma of `noise`: what no model of the past predicts better
};

/// The smallest slow effect that the record would have shown: a straight line in time that is
/// found nine times in ten.
struct DetectionLimit {
  std::string port;
  std::string unit;
  double size = 0.0;  // change over the whole record
};

/// Offsets of every output and every port by window of the record, all at once.
struct Omnibus {
  double p_value = 1.0;
  double p_adjusted = 1.0;   // after Holm, with the unmeasured causes: for the verdict
  bool significant = false;  // p_adjusted is below what the options ask
  std::string where = {};    // the port or output whose offsets explain most
  std::vector<std::pair<std::string, double>> windows =
      {};  // and how far off each window is [sigma]
};

enum class UnmeasuredKind {
  common_cause,  // outputs whose noise should be independent move together
  spectral_line  // a swing at one frequency, narrower than a resonance
};

/// "common_cause", "spectral_line".
std::string_view to_string(UnmeasuredKind kind);

/// A cause that no logged channel follows. Times are rows, frequencies cycles a row, where the
/// record has no time.
struct UnmeasuredCause {
  UnmeasuredKind kind = UnmeasuredKind::common_cause;
  std::vector<std::string> outputs = {};  // that show it
  double p_value = 1.0;                   // for itself, corrected for all that it was chosen among
  double p_adjusted = 1.0;                // after Holm: for the verdict
  bool all_along = false;                 // strongest over the whole record
  double first_s = 0.0;                   // of the rows where it is strongest [s]
  double last_s = 0.0;
  double frequency = not_a_number;  // [Hz]; NaN where none stands out
};

/// What to add, once a real fit with it has shown that it can be.
struct Advice {
  std::string effect = {};                 // none where nothing was found or all was withheld
  std::vector<std::string> withheld = {};  // why not what was found before it: a sentence each
  std::string then = {};  // its partner, where two were found that neither does alone
};

/// What a diagnosis did.
struct DiagnosisWork {
  std::size_t screened = 0;            // candidates
  std::size_t tested = 0;              // by likelihood ratios, their noise estimated anew
  std::size_t calibrated = 0;          // by draws of the noise
  std::size_t drawn = 0;               // these draws, of each noise
  std::size_t refitted = 0;            // models with a candidate that were fitted
  std::size_t tried_on_some_rows = 0;  // the same to 400 rows, where a fit is far off

  DiagnosisWork& operator+=(const DiagnosisWork& other);
};

struct Diagnosis {
  Verdict verdict = Verdict::adequate;
  Advice advice = {};
  std::vector<EffectFinding> effects = {};      // ranked, best first
  PseBound pse = PseBound::sidpac;              // of their structure
  DiagnosisRule rule = DiagnosisRule::verdict;  // what decided
  /// Two causes at once: the pairs that explain it as well as anything does and better than either
  /// of the two alone, best first.
  std::vector<std::string> pairs = {};
  std::vector<ResidualNoise> residual = {};
  Omnibus omnibus;
  std::vector<UnmeasuredCause> unmeasured = {};  // that are significant, the surest first
  std::vector<DetectionLimit> limits = {};
  double rmse = 0.0;   // over all outputs
  double floor = 0.0;  // innovations alone, over all outputs
  /// Over what time the most correlated output's residual goes together (its integrated correlation
  /// time) [s]; rows where the record has no time.
  double correlation_time = 0.0;
  bool has_time = false;
  std::string unit = {};  // of both; empty where the outputs have different ones: shares of each
                          // output's own
  std::vector<ErrorBound> error_budget = {};  // how far errors were let wander
  DiagnosisWork work = {};
  std::vector<std::string> left_undone = {};  // steps for which there was no time
};

/// From which ratio of the RMSE to what noise alone would leave on nobody may say that nothing is
/// missing: noise that goes together, as an autoregression of 0.9 does, leaves 2.3.
inline constexpr double well_above_floor = 1.5;

/// From which share of the error on rows held out on a candidate, fitted for real, speaks against
/// an adequate model.
inline constexpr double objects_from = 0.2;

/// The names of those that stand so beside the first, in their order.
std::vector<std::string> list_beside(const Diagnosis& diagnosis, Beside beside);

inline constexpr double significant_below = 0.05;  // p after Holm
/// Of the error on rows held out: an effect that takes less is too small to be a cause, however
/// sure it is. Noise of the inputs and turbulence do as much, where a model is linearised about
/// what was read.
inline constexpr double least_gain = 0.01;
inline constexpr double visible_from = 0.05;  // a sine: below, an effect can't be seen
/// The same along a trajectory: a power of alpha about its trim is within 0.03 of what the aircraft
/// has, and twenty seconds tell it at sixty standard errors.
inline constexpr double visible_along_path = 0.01;

struct DiagnosisOptions {
  double significance = significant_below;  // of the verdict
  double unexplained_below = 0.01;          // p of offsets and of unmeasured causes, after Holm
  double least_visibility = visible_from;
  int simulations = 40;                     // of the noise, that calibrate a test
  std::vector<std::string> preferred = {};  // come first among those as likely
  PseBound pse = PseBound::sidpac;
  DiagnosisRule rule = DiagnosisRule::verdict;
  /// Of two that are found as a pair advises the one with the larger partial F, its partner then.
  bool one_at_a_time = false;
  /// The caller's candidates, where there are any, in place of a catalogue's: one that the record
  /// can't make is an error and not left out.
  std::vector<std::string> only = {};
  std::size_t others = 0;  // candidates that are asked elsewhere at once: Holm counts them
  /// How far errors wander at most, by their names (EffectKit::error_budget), where it is known.
  std::map<std::string, double> error_budget = {};
  double within = infinity;  // [s]: what is not done by then is left undone, and said
  std::uint64_t seed = 0;
  int threads = 0;
  FitProgress progress = {};
};

/// A fit to be diagnosed.
struct DiagnosedFit {
  std::shared_ptr<const BlockModel> model;  // without effects
  EffectKit kit;
  std::vector<EffectSetting> effects;  // that the fit has
  Record record;                       // as compose() takes it, before without_edges()
  std::vector<Segment> rows;           // that are used
  Fit fit;
  /// In which a filter follows the path of a model with a state: its innovations are then judged,
  /// not the residual, which remembers the noise of what is integrated. Of a fit by filter error
  /// that noise which it found. None: the residual.
  std::optional<PathNoise> noise = {};
};

/// What an effect promises before it is added. Undefined numbers are NaN.
struct Promise {
  /// Of the RMSE over all outputs, by one step from the fit; of a model with a state by a real fit,
  /// as what it lacks may have bent its own parameters, from where one step sees little.
  double predicted_drop = not_a_number;
  double held_out_before = not_a_number;  // RMSE of rows left out, by real fits to the others
  double held_out_after = not_a_number;
  std::string against = {};  // why diagnose() would not advise it; empty where a fit bears it out
};

/// Of `effect`, a name or "E1+E2". `shapes`: where a step or another shape was found. Throws Error
/// where the record can't make it.
Promise promise(const DiagnosedFit& fitted, const std::string& effect,
                const std::map<std::string, double>& shapes, int threads = 0);

/// What one step from the fit promises of effects at their shapes, before noise is asked: of the
/// RMSE over all outputs, 1 - after / before. NaN where the record can't tell one. As it was of
/// those whose drop is that of a fit.
std::vector<double> predicted_drops(const DiagnosedFit& fitted,
                                    const std::vector<EffectFinding>& effects, int threads = 0);

/// Tries `candidates`, by their names or as "E1+E2". Those that the record can't make (a channel
/// that isn't there or is constant) are left out, or are errors where options.only has names.
/// Throws Error for a fit whose parameters are not those of its model.
Diagnosis diagnose(const DiagnosedFit& fitted, const std::vector<std::string>& candidates,
                   const DiagnosisOptions& options = {});

}  // namespace sepcal
