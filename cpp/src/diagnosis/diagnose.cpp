// SPDX-License-Identifier: BSD-3-Clause
// The recipe in order: make the candidates, screen all of them, test those near the top, calibrate
// what slow noise could imitate, hold rows out, correct for their number; where no single one
// passes those that a path has bent to, then pairs; fit the few that pass; and where nothing does,
// ask whether a real fit of anything speaks against the model, and whether anything is there.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

#include "base/stop.hpp"
#include "diagnosis/alternatives.hpp"
#include "diagnosis/candidate_testing.hpp"
#include "diagnosis/finding.hpp"
#include "diagnosis/nonlinear_effects.hpp"
#include "diagnosis/omnibus.hpp"
#include "diagnosis/own_fit.hpp"
#include "diagnosis/pair_set.hpp"
#include "diagnosis/residual_noise.hpp"
#include "diagnosis/rivals.hpp"
#include "diagnosis/unmeasured.hpp"
#include "diagnosis/weighing.hpp"
#include "numerics/order_statistics.hpp"
#include "numerics/selection.hpp"
#include "numerics/tails.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace diagnosis;  // this room's own

namespace {

using Eigen::Index;

constexpr std::size_t most_tested = 12;  // of either screen's best
constexpr std::size_t most_paired = 10;
constexpr std::size_t most_pairs_tested = 5;

/// What is found first, then what is surer.
void rank(std::vector<EffectFinding>& findings) {
  std::ranges::stable_sort(findings, [](const EffectFinding& a, const EffectFinding& b) {
    if (a.status != b.status) return a.status < b.status;
    return a.log10_p < b.log10_p;
  });
}

/// The tail of a trial by its fit: one step may see little in what bends the model.
void bound_by_fit(const CandidateTesting& testing, Trial& trial) {
  if (!testing.instruments()) return;
  try {
    const LinearisedFit with = testing.refits().linearise(trial.candidate, trial.shape);
    const auto coefficients = static_cast<Index>(trial.candidate.coefficients.size());
    const InstrumentTail tail = testing.instruments()->tail_of_fit(with, coefficients);
    if (!trial.tested) trial.slow = is_slow(testing.room(), trial.candidate, trial.shape);
    bound(tail, trial);
  } catch (const Error&) {
    return;  // no fit takes it
  }
}

bool takes_much(const EffectFinding& finding) {
  return finding.held_out_passed && finding.held_out_gain >= objects_from;
}

double count_visible(const Trials& trials) {
  return static_cast<double>(std::ranges::count(trials, true, &Trial::visible));
}

/// The median time from row to row.
double typical_interval(const std::vector<double>& times) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) intervals.push_back(times[i] - times[i - 1]);
  return intervals.empty() ? 1.0 : numerics::upper_median(std::move(intervals));
}

/// Of an effect found among `number` that could have been.
double share_after_selection(const EffectFinding& finding, double significance, double number) {
  constexpr double beyond_doubt = 1e-60;
  if (finding.p_value < beyond_doubt) return 1.0;
  // p asks what noise could do at its worst; the errors are those of the noise that there is.
  double size = std::sqrt(numerics::chi_squared_point(finding.p_value, 1.0));
  for (const Coefficient& one : finding.coefficients) {
    if (one.standard_error > 0.0) {
      size = std::max(size, std::abs(one.estimate) / one.standard_error);
    }
  }
  return numerics::share_after_selection(
      size, std::sqrt(numerics::chi_squared_point(significance / number, 1.0)));
}

class Recipe {
 public:
  Recipe(const DiagnosedFit& fitted, const DiagnosisOptions& options)
      : fitted_(fitted),
        options_(options),
        pool_(options.threads),
        testing_(fitted, options, pool_) {}

  Diagnosis run(const std::vector<std::string>& names);

 private:
  /// Does a step as far as the time allows.
  void in_time(const std::string& step, const std::function<void()>& work);
  std::vector<EffectFinding> collect(const Trials& trials, double tests) const;
  /// `tests`: how many could have been chosen; `slow_too`: whether slow changes are told.
  std::vector<EffectFinding> judge(Trials& trials, double tests, bool slow_too);
  /// Where a trial was made.
  const CandidateTesting& bench_of(const Trial& trial) const;
  bool takes_too_little(double held_out_gain) const;
  void doubt_readings(Trial& trial);
  double threshold_of(const Trials& trials, double tests) const;
  bool has(FindingStatus status) const;
  Trials::iterator find_trial(const std::string& name);
  double tests() const;
  void look_from_own_fits();
  bool is_of_one(const EffectFinding& pair);
  void try_pairs();
  void confirm(const Alternative& alternative);
  bool try_pairs_of_lines();
  void order_found();
  void judge_beside(const Alternative* first);
  void settle();
  Objection object_to(const EffectFinding& finding);
  void tell_fitted(EffectFinding& finding);
  void advise();
  void advise_pairs_of_lines();
  bool withdraw();
  void weigh_held_out();
  void put_line_first();
  void explain_away();
  void conclude();
  void choose_by_partial_f();
  void take_apart();

  using Clock = std::chrono::steady_clock;

  const DiagnosedFit& fitted_;
  const DiagnosisOptions& options_;
  Clock::time_point begun_ = Clock::now();
  base::ThreadPool pool_;
  CandidateTesting testing_;
  Trials trials_;
  std::unique_ptr<CandidateTesting> undisturbed_;            // made where it is asked
  std::map<std::string, std::unique_ptr<OwnFit>> own_fits_;  // of what a step did not find
  ModelSelection selection_;
  std::vector<std::string> withdrawn_;      // were found, but no fit bears them out
  std::vector<std::string> beyond_bounds_;  // of these, as a fit would take more than it may
  double left_by_first_ = 1.0;  // of the error, by a first that takes much and no fit takes
  Diagnosis result_;
};

void Recipe::in_time(const std::string& step, const std::function<void()>& work) {
  if (std::isinf(options_.within)) return work();
  struct OutOfTime : std::exception {};
  base::Stop* const outer = base::heeded_stop();
  const auto ask = [&] {
    const base::HeedStop as_asked(outer);
    base::heed_stop();
    if (std::chrono::duration<double>(Clock::now() - begun_).count() > options_.within) {
      throw OutOfTime();
    }
  };
  try {
    ask();
    const StopScope scope(ask);
    work();
  } catch (const OutOfTime&) {
    result_.left_undone.push_back(step);
  }
}

const CandidateTesting& Recipe::bench_of(const Trial& trial) const {
  const auto own = own_fits_.find(trial.candidate.name);
  return own == own_fits_.end() ? testing_ : own->second->testing();
}

bool Recipe::has(FindingStatus status) const {
  return std::ranges::find(result_.effects, status, &EffectFinding::status) !=
         result_.effects.end();
}

Trials::iterator Recipe::find_trial(const std::string& name) {
  return std::ranges::find_if(trials_,
                              [&](const Trial& trial) { return trial.candidate.name == name; });
}

/// How many effects could have been chosen.
double Recipe::tests() const {
  return count_visible(trials_) + static_cast<double>(options_.others);
}

/// Described, with the probabilities corrected for their number and the status that follows.
std::vector<EffectFinding> Recipe::collect(const Trials& trials, double tests) const {
  std::vector<double> log10_p;
  std::vector<std::size_t> visible;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    if (!trials[i].visible) continue;
    visible.push_back(i);
    log10_p.push_back(trials[i].log10_p);
  }
  // Those that could have been chosen and were not count as if they had said nothing.
  log10_p.resize(std::max(log10_p.size(), static_cast<std::size_t>(tests)), 0.0);
  const std::vector<double> holm = numerics::adjust_by_holm(log10_p);
  const std::vector<double> listed = numerics::adjust_by_benjamini_hochberg(log10_p);
  std::vector<EffectFinding> findings;
  std::size_t v = 0;
  for (std::size_t i = 0; i < trials.size(); ++i) {
    const CandidateTesting& testing = bench_of(trials[i]);
    EffectFinding finding = describe(testing.room(), trials[i]);
    finding.structure = structure_of(testing.null(), trials[i], options_.pse);
    if (v < visible.size() && visible[v] == i) {
      finding.p_adjusted = holm[v];
      finding.p_listed = listed[v];
      ++v;
      const auto number = static_cast<double>(log10_p.size());
      if (!finding.held_out_passed) {
        // whatever it is, it does not predict
      } else if (finding.p_adjusted < options_.significance) {
        if (!takes_too_little(finding.held_out_gain)) finding.status = FindingStatus::found;
        finding.share_after_selection =
            share_after_selection(finding, options_.significance, number);
      } else if (may_be_slow(trials[i], std::log10(options_.significance / number))) {
        finding.status = FindingStatus::slow_change;
      }
    }
    findings.push_back(std::move(finding));
  }
  return findings;
}

bool Recipe::takes_too_little(double held_out_gain) const {
  return !fitted_.kit.error_budget.empty() && held_out_gain < least_gain;
}

/// log10 of about what Holm's correction asks for, where `tests` could have been chosen.
double Recipe::threshold_of(const Trials& trials, double tests) const {
  constexpr double about = 0.3;
  const double number = std::max({1.0, count_visible(trials), tests});
  return std::log10(options_.significance / number) + about;
}

/// No surer than where what the model leaves stands in the readings that columns are made of: there
/// it goes with them, and imitates whatever changes their errors. Noise of free size would take a
/// cause for its own there, so noise as instruments have it is asked.
void Recipe::doubt_readings(Trial& trial) {
  if (fitted_.kit.disturbed.empty() || testing_.room().follows_path()) return;
  if (!undisturbed_)
    undisturbed_ = std::make_unique<CandidateTesting>(testing_, Regressors::undisturbed);
  const std::optional<double> log10_p = undisturbed_->bounded_tail(trial.candidate.name);
  if (log10_p) trial.log10_p = std::max(trial.log10_p, *log10_p);
}

std::vector<EffectFinding> Recipe::judge(Trials& trials, double tests, bool slow_too) {
  testing_.hold_out_significant(trials, slow_too);
  const double threshold = threshold_of(trials, tests);
  testing_.calibrate_significant(trials, threshold, slow_too);
  testing_.confirm_best(trials, threshold);
  for (Trial& trial : trials) {
    const bool would_be_found = trial.held_out.passed && trial.log10_p < threshold;
    if (would_be_found && !takes_too_little(trial.held_out.gain)) doubt_readings(trial);
  }
  std::vector<EffectFinding> findings = collect(trials, tests);
  rank(findings);
  return findings;
}

/// What the fit has bent its own parameters to is found where a fit that has it ends.
void Recipe::look_from_own_fits() {
  testing_.report_progress("fitting what may be hidden", 0.0);
  const double number = std::max(1.0, tests());
  for (std::unique_ptr<OwnFit>& own : find_hidden(testing_, trials_)) {
    Trial found = own->test(threshold_of(trials_, number));
    Trial& trial = *std::ranges::find_if(
        trials_, [&](const Trial& other) { return other.candidate.name == found.candidate.name; });
    if (!found.visible || !(found.log10_p < trial.log10_p)) continue;
    own_fits_.emplace(found.candidate.name, std::move(own));
    trial = std::move(found);
  }
  result_.effects = collect(trials_, number);
  rank(result_.effects);
}

/// Whether one of a pair leaves as little of the error on rows held out as both.
bool Recipe::is_of_one(const EffectFinding& pair) {
  constexpr double about = 1.05;
  const Candidate& both = testing_.room().make(pair.name);
  return std::ranges::any_of(both.settings, [&](const EffectSetting& member) {
    const auto alone = find_trial(member.name);
    if (alone == trials_.end() || !alone->visible) return false;
    if (alone->folds.count == 0) hold_out(testing_.room(), testing_.null(), *alone);
    return alone->held_out.judged && 1.0 - alone->held_out.gain <= about * left_out(pair);
  });
}

/// Of those that are no functions of any form: two of these explain too much.
void Recipe::try_pairs() {
  std::vector<std::string> best;
  double visible = 0.0;
  for (const EffectFinding& finding : result_.effects) {
    if (finding.status == FindingStatus::cannot_be_seen) continue;
    ++visible;
    if (best.size() == most_paired || !finding.shapes.empty()) continue;
    if (is_simple(testing_.room().make(finding.name))) best.push_back(finding.name);
  }
  std::vector<std::string> names;
  for (std::size_t a = 0; a < best.size(); ++a) {
    for (std::size_t b = a + 1; b < best.size(); ++b) names.push_back(best[a] + "+" + best[b]);
  }
  Trials pairs = testing_.make(names);
  testing_.screen_all(pairs);
  // The ten were chosen by what they explain: every pair of all candidates could have been.
  const double tests = 0.5 * (visible + static_cast<double>(options_.others)) * (visible - 1.0);
  testing_.test_best(pairs, most_pairs_tested, threshold_of(pairs, tests), false);
  std::vector<EffectFinding> findings = judge(pairs, tests, false);
  std::erase_if(findings, [&](const EffectFinding& pair) {
    return pair.status != FindingStatus::found || is_of_one(pair);
  });
  result_.effects.insert(result_.effects.begin(), findings.begin(), findings.end());
}

/// What rows held out say of an alternative, by fits in place of one step.
void Recipe::confirm(const Alternative& alternative) {
  const auto trial = find_trial(alternative.candidate.name);
  if (trial == trials_.end() || !std::isfinite(alternative.criterion)) return;
  if (trial->folds.count == 0) hold_out(testing_.room(), testing_.null(), *trial);
  diagnosis::confirm(testing_.refits(), *trial);
  tell_held_out(*trial, *std::ranges::find(result_.effects, alternative.candidate.name,
                                           &EffectFinding::name));
}

/// What is no line may stand for two of them, and no fit bears out one of two alone: the best pairs
/// of lines are alternatives too. Returns whether any is.
bool Recipe::try_pairs_of_lines() {
  constexpr std::size_t most_fitted = 3;
  std::vector<std::string> names = find_pair_set(testing_, trials_, selection_.noise, true);
  if (names.size() > most_fitted) names.resize(most_fitted);
  std::erase_if(names, [&](const std::string& name) { return find_trial(name) != trials_.end(); });
  Trials pairs = testing_.make(names);
  const auto lines = static_cast<double>(std::ranges::count_if(trials_, [](const Trial& trial) {
    return trial.visible && is_of_lines(trial.candidate, 1);
  }));
  const double tests = 0.5 * lines * (lines - 1.0);
  testing_.screen_all(pairs);
  testing_.test_best(pairs, most_fitted, threshold_of(pairs, tests), false);
  std::vector<Alternative> asked;
  for (EffectFinding& finding : judge(pairs, tests, false)) {
    if (finding.status != FindingStatus::found) continue;
    asked.push_back({testing_.room().make(finding.name), shape_of(finding)});
    trials_.push_back(*std::ranges::find_if(
        pairs, [&](const Trial& pair) { return pair.candidate.name == finding.name; }));
    result_.effects.push_back(std::move(finding));
  }
  std::ranges::stable_sort(result_.effects, {}, &EffectFinding::status);
  fit_all(testing_, selection_.noise, asked);
  for (Alternative& alternative : asked) {
    confirm(alternative);
    selection_.alternatives.push_back(std::move(alternative));
  }
  return !asked.empty();
}

/// The order of what was found, and what becomes of the others beside the first: by real fits.
void Recipe::settle() {
  testing_.report_progress("fitting what was found", 0.0);
  selection_ = fit_alternatives(testing_, result_.effects);
  for (const Alternative& alternative : selection_.alternatives) confirm(alternative);
  admit_nonlinear(testing_, selection_, result_.effects);
  const Alternative* first = put_first(selection_, options_.preferred, result_.effects);
  if (first && !is_of_lines(first->candidate, 1) && !testing_.room().follows_path() &&
      try_pairs_of_lines()) {
    first = put_first(selection_, options_.preferred, result_.effects);
  }
  judge_beside(first);
}

void Recipe::order_found() {
  judge_beside(put_first(selection_, options_.preferred, result_.effects));
}

/// What becomes of the others beside the one that stands first.
void Recipe::judge_beside(const Alternative* first) {
  promise_by_fits(testing_, selection_, result_.effects);
  if (first) test_beside(testing_, *first, result_.effects);
  result_.pairs = find_pair_set(testing_, trials_, selection_.noise);
  for (const Trial& trial : trials_) {
    if (trial.candidate.name == result_.effects.front().name) {
      result_.floor = std::min(result_.floor, trial.floor);
    }
  }
}

Objection Recipe::object_to(const EffectFinding& finding) {
  Objection objection = object(testing_, selection_, finding);
  if (objection.reason.empty()) {
    objection.reason = find_rival(testing_, selection_, finding, result_.effects);
    objection.is_of_rival = !objection.reason.empty();
  }
  return objection;
}

/// Its size by a fit with it: one step's errors are none where the model is bent.
void Recipe::tell_fitted(EffectFinding& finding) {
  const Candidate& candidate = testing_.room().make(finding.name);
  const double shape = shape_of(finding);
  try {
    const Fit fitted = testing_.room().follows_path()
                           ? testing_.refits().with(candidate, shape)
                           : refit_nearly(testing_.room(), candidate, shape, enough_rows, true);
    testing_.count({.refitted = testing_.room().follows_path() ? 0U : 1U});
    for (Coefficient& coefficient : finding.coefficients) {
      const Parameter& parameter = fitted[coefficient.name];
      coefficient.estimate = parameter.value;
      coefficient.standard_error = parameter.standard_error;
    }
    finding.is_fitted = true;
  } catch (const Error&) {
    return;  // the step's estimate stands
  }
}

/// The best of what was found that a real fit bears out and no other contradicts.
void Recipe::advise() {
  constexpr std::size_t most_fitted = 6;
  constexpr double most_of = 0.4;  // of what the first takes, where no fit takes that
  std::size_t fitted = 0;
  bool first_stands = false;  // though no fit takes it
  for (EffectFinding& finding : result_.effects) {
    if (finding.status != FindingStatus::found || fitted == most_fitted) return;
    if (finding.beside == Beside::fades) {  // it explains what the first does
      const bool does_much =
          finding.held_out_gain > most_of * result_.effects.front().held_out_gain;
      if (fitted == 0 || !does_much) continue;
    }
    if (first_stands && finding.beside == Beside::counts) continue;  // alone it would stand in
    const Objection objection = object_to(finding);
    if (std::isfinite(objection.drop)) {
      finding.predicted_drop = objection.drop;
      finding.drop_is_fitted = true;
      result_.floor = std::min(result_.floor, result_.rmse * (1.0 - objection.drop));
    }
    if (objection.reason.empty()) {
      result_.advice.effect = finding.name;
      tell_fitted(finding);
      return;
    }
    if (fitted == 0) first_stands = objection.is_to_fit;
    if (fitted == 0 && first_stands && takes_much(finding)) {
      left_by_first_ = std::min(left_by_first_, left_out(finding));
    }
    ++fitted;
    const std::string reason = finding.name + ": " + objection.reason;
    std::vector<std::string>& withheld = result_.advice.withheld;
    if (std::ranges::find(withheld, reason) == withheld.end()) withheld.push_back(reason);
    if (!objection.is_of_rival) withdrawn_.push_back(finding.name);
    if (objection.is_of_bounds) beyond_bounds_.push_back(finding.name);
  }
}

/// Advises pairs of lines, and forgets them where no fit bears out two of them either.
void Recipe::advise_pairs_of_lines() {
  Diagnosis alone = result_;
  const auto trials = static_cast<std::ptrdiff_t>(trials_.size());
  std::vector<Alternative>& alternatives = selection_.alternatives;
  const auto entered = static_cast<std::ptrdiff_t>(alternatives.size());
  if (!try_pairs_of_lines()) return;
  order_found();
  const std::vector<std::string> withdrawn = std::exchange(withdrawn_, {});
  result_.advice = {};
  advise();
  if (!result_.advice.effect.empty()) return;
  result_ = std::move(alone);
  withdrawn_ = withdrawn;
  trials_.erase(trials_.begin() + trials, trials_.end());
  alternatives.erase(alternatives.begin() + entered, alternatives.end());
}

/// What was found and no fit bears out is no finding, nor is then what fades beside it, nor what
/// leaves clearly more than a first that takes much though no fit takes it: alone it would stand
/// in. Returns whether something else that was found stands first now.
bool Recipe::withdraw() {
  const bool nothing_stands =  // one that a rival alone speaks against does
      result_.advice.effect.empty() &&
      std::ranges::find(withdrawn_, result_.effects.front().name) != withdrawn_.end();
  for (EffectFinding& finding : result_.effects) {
    const bool is_withdrawn = std::ranges::find(withdrawn_, finding.name) != withdrawn_.end() ||
                              (nothing_stands && finding.beside == Beside::fades);
    if (finding.status != FindingStatus::found || !is_withdrawn) continue;
    const auto trial = find_trial(finding.name);
    const bool wants_more =
        std::ranges::find(beyond_bounds_, finding.name) != beyond_bounds_.end() &&
        !takes_too_little(finding.held_out_gain);
    if (!takes_much(finding) && !wants_more) {
      finding.status = FindingStatus::not_seen;
    } else {
      finding.status = trial != trials_.end() && trial->slow ? FindingStatus::slow_change
                                                             : FindingStatus::undecided;
    }
  }
  for (EffectFinding& finding : result_.effects) {
    const bool stands_in = nothing_stands && clearly_less * left_out(finding) > left_by_first_;
    if (finding.status == FindingStatus::found && stands_in) {
      finding.status = FindingStatus::not_seen;
    }
  }
  const bool first_stands = result_.effects.front().status == FindingStatus::found;
  std::ranges::stable_sort(result_.effects, [](const EffectFinding& a, const EffectFinding& b) {
    if (a.status != b.status) return a.status < b.status;
    return a.status == FindingStatus::not_seen && a.log10_p < b.log10_p;
  });
  if (first_stands) return false;
  for (EffectFinding& finding : result_.effects) {
    finding.beside = Beside::untried;  // they were asked beside what is withdrawn
  }
  return has(FindingStatus::found);
}

/// What takes much of the error on rows held out by a real fit is said, whatever noise could do:
/// rows that lie further apart than noise remembers do not care about its model.
void Recipe::weigh_held_out() {
  const double significant = std::log10(options_.significance / std::max(1.0, tests()));
  std::vector<EffectFinding*> chosen = choose_to_weigh(testing_, result_.effects);
  if (is_far_off(testing_, result_.floor)) {  // one step may see little in what explains everything
    for (const Alternative& bent : try_on_some_rows(testing_, result_.effects, {})) {
      EffectFinding& finding =
          *std::ranges::find(result_.effects, bent.candidate.name, &EffectFinding::name);
      if (std::ranges::find(chosen, &finding) == chosen.end()) chosen.push_back(&finding);
    }
  }
  for (EffectFinding* finding : chosen) {
    testing_.report_progress("fitting what takes much of the error", 0.0);
    const auto at = find_trial(finding->name);
    if (at == trials_.end()) continue;  // a pair, whose members are asked
    Trial& trial = *at;
    if (trial.folds.count == 0) hold_out(testing_.room(), testing_.null(), trial);
    diagnosis::confirm(testing_.refits(), trial);
    tell_held_out(trial, *finding);
    if (!trial.held_out.passed || !(finding->held_out_gain >= objects_from)) continue;
    bound_by_fit(testing_, trial);
    if (trial.log10_p < significant) doubt_readings(trial);
    if (trial.log10_p < significant) {
      finding->status = FindingStatus::found;
      finding->log10_p = trial.log10_p;
      finding->p_value = std::pow(10.0, trial.log10_p);
      finding->p_adjusted = std::min(1.0, finding->p_value * std::max(1.0, tests()));
      finding->p_listed = finding->p_adjusted;
    } else {
      finding->status = trial.slow ? FindingStatus::slow_change : FindingStatus::undecided;
    }
  }
  if (has(FindingStatus::found)) {
    rank(result_.effects);
  } else {
    put_simplest_first(testing_, result_.effects);
    put_line_first();
  }
}

/// A function of any form that takes much has been chosen to follow the noise too: where a line
/// along its channel leaves hardly more, this stands first, as what would do as well.
void Recipe::put_line_first() {
  if (result_.effects.empty()) return;  // nothing was asked that the fit lacks
  const EffectFinding first = result_.effects.front();
  if (first.status != FindingStatus::slow_change && first.status != FindingStatus::undecided)
    return;
  const auto curve = find_trial(first.name);
  if (curve == trials_.end() || !is_of_any_form(curve->candidate)) return;
  auto best = trials_.end();
  for (auto trial = trials_.begin(); trial != trials_.end(); ++trial) {
    if (!trial->visible || !is_line_of(trial->candidate, curve->candidate, false)) continue;
    if (trial->folds.count == 0) hold_out(testing_.room(), testing_.null(), *trial);
    if (!trial->held_out.passed) continue;
    if (best == trials_.end() || trial->held_out.gain > best->held_out.gain) best = trial;
  }
  if (best == trials_.end()) return;
  diagnosis::confirm(testing_.refits(), *best);
  if (!does_nearly_as_well(1.0 - best->held_out.gain, left_out(first))) return;
  const auto line = std::ranges::find(result_.effects, best->candidate.name, &EffectFinding::name);
  tell_held_out(*best, *line);
  line->status = first.status;
  result_.effects.front().beside = Beside::equivalent;
  std::rotate(result_.effects.begin(), line, line + 1);
  result_.effects.front().beside = Beside::untried;
}

/// How far errors would have to wander to look like the slow effect that stands first.
void Recipe::explain_away() {
  EffectFinding& first = result_.effects.front();
  const auto trial = find_trial(first.name);
  if (!testing_.instruments() || trial == trials_.end() || !trial->slow) return;
  const double wanted =
      std::log10(options_.significance / std::max(1.0, tests())) - log10_scan(*trial);
  first.excuse = testing_.instruments()->excuse(
      project_trial(testing_.room(), testing_.null(), *trial, trial->shape).basis, wanted,
      first.status == FindingStatus::found ? 2.0 : 1.0);
}

/// The verdict: one function of all that is known of the candidates.
void Recipe::conclude() {
  if (has(FindingStatus::found)) {
    result_.verdict = Verdict::effect_missing;
    in_time("excuses", [&] { explain_away(); });
    return;
  }
  in_time("looking for structure", [&] {
    testing_.report_progress("looking for structure", 0.0);
    result_.omnibus =
        test_for_structure(testing_.room(), fitted_.kit, testing_.null(), testing_.instruments(),
                           testing_.inputs(), options_, pool_);
    result_.unmeasured =
        find_unmeasured(testing_.room(), testing_.null(), testing_.inputs(), options_.seed);
  });
  correct_together(options_.unexplained_below, result_.omnibus, result_.unmeasured);
  if (has(FindingStatus::slow_change)) {
    result_.verdict = Verdict::slow_change;
    in_time("excuses", [&] { explain_away(); });
  } else if (result_.omnibus.significant || !result_.unmeasured.empty() ||
             has(FindingStatus::undecided)) {
    result_.verdict = Verdict::unexplained;
  }
}

/// Of a pair that is advised the one that takes more goes first, where it does much alone, and the
/// other after it: as sure as the pair is.
void Recipe::take_apart() {
  const auto pair = std::ranges::find(result_.effects, result_.advice.effect, &EffectFinding::name);
  if (pair == result_.effects.end()) return;
  const std::array both{pair->log10_p, pair->p_value, pair->p_adjusted, pair->p_listed};
  std::vector<std::string> names = split_effects(pair->name);
  if (names.size() != 2) return;
  const auto find = [&](const std::string& name) {
    return std::ranges::find(result_.effects, name, &EffectFinding::name);
  };
  const auto f_of = [&](const std::string& name) { return find(name)->structure.partial_f; };
  if (find(names[0]) == result_.effects.end() || find(names[1]) == result_.effects.end()) return;
  if (f_of(names[1]) > f_of(names[0])) std::swap(names[0], names[1]);
  if (!(f_of(names[0]) >= enters_from)) return;
  for (const std::string& name : {names[1], names[0]}) {
    const auto finding = find(name);
    Trial& trial = *find_trial(name);
    if (trial.folds.count == 0) hold_out(testing_.room(), testing_.null(), trial);
    tell_held_out(trial, *finding);
    finding->status = FindingStatus::found;
    std::tie(finding->log10_p, finding->p_value, finding->p_adjusted, finding->p_listed) =
        std::tuple_cat(both);
    finding->beside = name == names[1] ? Beside::counts : Beside::untried;
    std::rotate(result_.effects.begin(), finding, finding + 1);
  }
  result_.advice.effect = names[0];
  result_.advice.then = names[1];
}

/// As stepwise regression does: the largest partial F enters, one candidate at a time.
void Recipe::choose_by_partial_f() {
  in_time("screening effects", [&] { testing_.screen_all(trials_); });
  for (const Trial& trial : trials_) {
    EffectFinding finding = describe(testing_.room(), trial);
    finding.structure = structure_of(testing_.null(), trial, options_.pse);
    finding.log10_p = finding.p_value = not_a_number;  // no probability is asked
    const double partial_f = finding.structure.partial_f;
    if (partial_f >= enters_from) finding.status = FindingStatus::found;
    result_.effects.push_back(std::move(finding));
  }
  std::ranges::stable_sort(result_.effects, [](const EffectFinding& a, const EffectFinding& b) {
    if (a.status != b.status) return a.status < b.status;
    return a.structure.partial_f > b.structure.partial_f;
  });
  if (has(FindingStatus::found)) {
    result_.verdict = Verdict::effect_missing;
    result_.advice.effect = result_.effects.front().name;
  }
}

Diagnosis Recipe::run(const std::vector<std::string>& names) {
  result_.pse = options_.pse;
  result_.rule = options_.rule;
  if (testing_.is_exact()) return result_;  // nothing is left to explain
  const CandidateRoom& room = testing_.room();
  const RowLayout& layout = room.fit().layout;
  result_.residual = describe_residual(testing_.null());
  result_.rmse = total_rmse(layout, room.fit().residual);
  result_.unit = common_unit(layout);
  result_.floor = noise_floor(layout, testing_.null().best.noise);
  result_.correlation_time =
      correlation_rows(layout, room.fit().residual) * typical_interval(room.times());
  result_.has_time = room.record().has("time");
  if (!options_.only.empty()) {
    for (const std::string& name : names) testing_.room().make(name);  // or the reason is thrown
  }
  trials_ = testing_.make(names);
  if (options_.rule == DiagnosisRule::partial_f) {
    choose_by_partial_f();
    result_.work = testing_.work();
    return result_;
  }
  in_time("screening effects", [&] { testing_.screen_all(trials_); });
  in_time("testing effects",
          [&] { testing_.test_best(trials_, most_tested, threshold_of(trials_, tests()), true); });
  in_time("holding rows out", [&] { result_.effects = judge(trials_, tests(), true); });
  if (result_.effects.empty()) result_.effects = collect(trials_, tests());
  if (!has(FindingStatus::found) && room.follows_path()) {
    in_time("fitting what may be hidden", [&] { look_from_own_fits(); });
  }
  if (!has(FindingStatus::found)) in_time("trying pairs", [&] { try_pairs(); });
  if (!has(FindingStatus::found)) {
    in_time("fitting what takes much of the error", [&] { weigh_held_out(); });
  }
  if (has(FindingStatus::found)) {
    in_time("fitting what was found", [&] { settle(); });
    in_time("fitting what is advised", [&] { advise(); });
    if (result_.advice.effect.empty() && !room.follows_path()) {
      in_time("fitting two at once", [&] { advise_pairs_of_lines(); });
    }
    constexpr int most_headlines = 4;
    for (int round = 0; withdraw() && round < most_headlines; ++round) {
      order_found();
      result_.advice.effect.clear();
      in_time("fitting what is advised", [&] { advise(); });
    }
  }
  if (options_.one_at_a_time) take_apart();
  if (testing_.instruments()) result_.error_budget = testing_.instruments()->bounds();
  conclude();
  in_time("limits", [&] {
    result_.limits = find_limits(testing_.room(), fitted_.kit, testing_.null(),
                                 testing_.instruments(), options_.significance, trials_.size());
  });
  if (undisturbed_) testing_.count(undisturbed_->work());
  result_.work = testing_.work();
  return result_;
}

}  // namespace

Diagnosis diagnose(const DiagnosedFit& fitted, const std::vector<std::string>& candidates,
                   const DiagnosisOptions& options) {
  if (options.rule == DiagnosisRule::verdict) return Recipe(fitted, options).run(candidates);
  constexpr double of_rounding = 1e-6;  // whatever is no combination of the others has a partial F
  DiagnosisOptions exact = options;
  exact.least_visibility = of_rounding;
  return Recipe(fitted, exact).run(candidates);
}

}  // namespace sepcal
