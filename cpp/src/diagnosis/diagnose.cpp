// SPDX-License-Identifier: BSD-3-Clause
// The recipe in order: make the candidates, screen all of them, test those near the top, calibrate
// what slow noise could imitate, hold rows out, correct for their number; pairs where no
// single one passes; and where nothing does, whether anything is there.
#include <algorithm>
#include <cmath>
#include <mutex>

#include "diagnosis/advice.hpp"
#include "diagnosis/finding.hpp"
#include "diagnosis/omnibus.hpp"
#include "diagnosis/ranking.hpp"
#include "diagnosis/residual_noise.hpp"
#include "diagnosis/trial.hpp"
#include "numerics/tails.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace diagnosis;  // this room's own

namespace {

constexpr std::size_t most_tested = 12;  // of either screen's best
constexpr std::size_t most_paired = 10;
constexpr std::size_t most_confirmed = 3;
constexpr double doubtless = -30.0;  // log10 of a tail for which few simulations do
constexpr int few_simulations = 39;
constexpr std::size_t most_calibrated = 3;  // the others are corrected as the worst of these
constexpr std::size_t most_pairs_tested = 5;

/// Whether what there is of it could be a slow change, were its noise known not to wander.
bool may_be_slow(const Trial& trial, double threshold) {
  return trial.tested && trial.slow && trial.tails.beside < threshold;
}

class Recipe {
 public:
  Recipe(const DiagnosedFit& fitted, const DiagnosisOptions& options)
      : fitted_(fitted), options_(options), pool_(options.threads), room_(fitted, pool_) {}

  Diagnosis run(const std::vector<std::string>& names);

 private:
  using Trials = std::vector<Trial>;

  void make(const std::vector<std::string>& names);
  void screen_all(Trials& trials);
  void test_best(Trials& trials, std::size_t most);
  void hold_out_significant(Trials& trials);
  void calibrate_significant(Trials& trials, double threshold);
  void confirm_best(Trials& trials, double threshold);
  std::vector<EffectFinding> collect(const Trials& trials, double tests) const;
  /// `tests`: how many could have been chosen.
  std::vector<EffectFinding> judge(Trials& trials, double tests);
  void try_pairs(const std::vector<EffectFinding>& singles);
  void rank_by_fits();
  void prefer_known();
  void advise();
  void report_progress(std::string_view task, double fraction) const {
    if (options_.progress) options_.progress(task, fraction);
  }

  const DiagnosedFit& fitted_;
  const DiagnosisOptions& options_;
  base::ThreadPool pool_;
  CandidateRoom room_;
  NullHypothesis null_;
  Tangent tangent_;
  Trials trials_;
  Diagnosis result_;
};

void Recipe::make(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    try {
      Trial trial{.candidate = room_.make(name)};
      trial.slow = is_slow(room_, trial.candidate);
      const bool twice = std::ranges::any_of(trials_, [&](const Trial& other) {
        return other.candidate.name == trial.candidate.name;
      });
      if (!twice) trials_.push_back(std::move(trial));
    } catch (const Error&) {
      continue;  // the record doesn't have what it takes
    }
  }
}

void Recipe::screen_all(Trials& trials) {
  std::mutex mutex;
  double done = 0.0;
  pool_.for_each(trials.size(), [&](std::size_t i) {
    trials[i].least_visibility = options_.least_visibility;
    screen(room_, null_, trials[i]);
    const std::lock_guard lock(mutex);
    report_progress("screening effects", ++done / static_cast<double>(trials.size()));
  });
}

void Recipe::test_best(Trials& trials, std::size_t most) {
  std::vector<std::size_t> chosen;
  for (double Trial::* const by : {&Trial::log10_white, &Trial::log10_plain}) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (trials[i].visible) order.push_back(i);
    }
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return trials[i].*by; });
    if (order.size() > most) order.resize(most);
    for (const std::size_t i : order) {
      if (std::ranges::find(chosen, i) == chosen.end()) chosen.push_back(i);
    }
  }
  std::mutex mutex;
  double done = 0.0;
  pool_.for_each(chosen.size(), [&](std::size_t k) {
    test(room_, null_, trials[chosen[k]]);
    const std::lock_guard lock(mutex);
    report_progress("testing effects", ++done / static_cast<double>(chosen.size()));
  });
}

void Recipe::hold_out_significant(Trials& trials) {
  const double threshold = std::log10(options_.significance);
  pool_.for_each(trials.size(), [&](std::size_t i) {
    if (trials[i].tested || (trials[i].visible && trials[i].log10_p < threshold)) {
      hold_out(room_, null_, trials[i]);
    }
  });
}

/// Corrects the tails of what would be significant; what was only screened is no surer than the
/// least sure of what was tested.
void Recipe::calibrate_significant(Trials& trials, double threshold) {
  std::vector<Trial*> significant;
  for (Trial& trial : trials) {
    if (trial.tested && (trial.log10_p < threshold || may_be_slow(trial, threshold))) {
      significant.push_back(&trial);
    }
  }
  std::ranges::stable_sort(significant, {}, &Trial::log10_p);
  double worst = 1.0;  // of what is left of a log10 p
  for (std::size_t i = 0; i < significant.size(); ++i) {
    report_progress("calibrating tests",
                    static_cast<double>(i) / static_cast<double>(significant.size()));
    Trial& trial = *significant[i];
    const double plain = trial.log10_p;
    if (i < most_calibrated) {
      const bool beyond_doubt = plain < doubtless;
      const int draws =
          beyond_doubt ? std::min(few_simulations, options_.simulations) : options_.simulations;
      calibrate(room_, null_, draws, options_.seed, pool_, trial);
      if (plain < 0.0) worst = std::min(worst, trial.log10_p / plain);
    } else {
      trial.log10_p = worst * plain;
      trial.tails = {worst * trial.tails.either, worst * trial.tails.beside};
    }
  }
  double least_sure = -infinity;
  for (const Trial& trial : trials) {
    if (trial.tested) least_sure = std::max(least_sure, trial.log10_p);
  }
  for (Trial& trial : trials) {
    if (trial.visible && !trial.tested) trial.log10_p = std::max(trial.log10_p, least_sure);
  }
}

/// One step may fail an effect that bends the model: those that explain more than the best that
/// passed get real fits.
void Recipe::confirm_best(Trials& trials, double threshold) {
  std::vector<Trial*> order;
  for (Trial& trial : trials) {
    if (trial.held_out.judged && trial.log10_p < threshold) order.push_back(&trial);
  }
  std::ranges::stable_sort(order, {}, &Trial::log10_p);
  std::size_t confirmed = 0;
  for (Trial* trial : order) {
    if (trial->held_out.passed || confirmed == most_confirmed) break;
    confirm(room_, pool_, *trial);
    ++confirmed;
    if (trial->held_out.passed) break;
  }
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
    EffectFinding finding = describe(room_, tangent_, trials[i]);
    if (v < visible.size() && visible[v] == i) {
      finding.p_adjusted = holm[v];
      finding.p_listed = listed[v];
      ++v;
      const double tried = std::log10(static_cast<double>(log10_p.size()));
      if (!finding.held_out_passed) {
        // whatever it is, it does not predict
      } else if (finding.p_adjusted < options_.significance) {
        finding.status = FindingStatus::found;
      } else if (may_be_slow(trials[i], std::log10(options_.significance) - tried)) {
        finding.status = FindingStatus::slow_change;
      }
    }
    findings.push_back(std::move(finding));
  }
  return findings;
}

std::vector<EffectFinding> Recipe::judge(Trials& trials, double tests) {
  hold_out_significant(trials);
  const auto visible_trials =
      static_cast<double>(std::ranges::count(trials, true, &Trial::visible));
  const double number = std::max({1.0, visible_trials, tests});
  const double threshold = std::log10(options_.significance / number) + 0.3;  // about Holm's
  calibrate_significant(trials, threshold);
  confirm_best(trials, threshold);
  std::vector<EffectFinding> findings = collect(trials, tests);
  rank(findings);
  const Comparisons among{room_, null_, trials, options_.family_correlation};
  prefer_simplest(among, findings);
  find_families(among, std::log10(options_.significance / static_cast<double>(findings.size())),
                pool_, findings);
  return findings;
}

void Recipe::try_pairs(const std::vector<EffectFinding>& singles) {
  std::vector<std::string> best;
  double visible = 0.0;
  for (const EffectFinding& finding : singles) {
    if (finding.status == FindingStatus::cannot_be_seen) continue;
    ++visible;
    if (best.size() < most_paired && finding.shapes.empty()) best.push_back(finding.name);
  }
  Trials pairs;
  for (std::size_t a = 0; a < best.size(); ++a) {
    for (std::size_t b = a + 1; b < best.size(); ++b) {
      try {
        pairs.push_back({.candidate = room_.make(best[a] + "+" + best[b])});
      } catch (const Error&) {
        continue;
      }
    }
  }
  screen_all(pairs);
  test_best(pairs, most_pairs_tested);
  // The ten were chosen by what they explain: every pair of all candidates could have been.
  std::vector<EffectFinding> findings = judge(pairs, 0.5 * visible * (visible - 1.0));
  std::erase_if(findings,
                [](const EffectFinding& pair) { return pair.status != FindingStatus::found; });
  result_.effects.insert(result_.effects.begin(), findings.begin(), findings.end());
}

/// One step from the fit can't rank what bends the model: of effects beyond doubt the one comes
/// first whose real fit leaves least.
void Recipe::rank_by_fits() {
  constexpr std::size_t most_fitted = 4;
  constexpr double margin = 5.0;  // in ln L
  constexpr double near = 0.8;    // of the first's log10 p
  const double first_p = result_.effects.front().log10_p;
  std::size_t rivals = 0;
  for (const EffectFinding& finding : result_.effects) {
    const bool found = finding.status == FindingStatus::found;
    if (!found || !(finding.log10_p < std::min(doubtless, near * first_p))) break;
    if (++rivals == most_fitted) break;
  }
  if (rivals < 2) return;
  std::vector<double> left;
  for (std::size_t i = 0; i < rivals; ++i) {
    left.push_back(criterion_with(room_, result_.effects[i]));
  }
  const auto best = std::ranges::min_element(left) - left.begin();
  if (!(left.front() - left[static_cast<std::size_t>(best)] > margin)) return;
  const auto first = result_.effects.begin();
  std::rotate(first, first + best, first + best + 1);
}

/// Of a family's effects one that is preferred comes first where it explains as much but for
/// little.
void Recipe::prefer_known() {
  constexpr double margin = 0.05;  // of log10 p, and of what the error falls by
  std::vector<EffectFinding>& effects = result_.effects;
  const auto is_preferred = [&](const EffectFinding& effect) {
    return std::ranges::find(options_.preferred, effect.name) != options_.preferred.end();
  };
  const EffectFinding& first = effects.front();
  if (is_preferred(first)) return;
  const auto preferred = std::ranges::find_if(effects, [&](const EffectFinding& effect) {
    return effect.status == FindingStatus::found && is_preferred(effect) &&
           effect.log10_p < (1.0 - margin) * first.log10_p &&
           effect.predicted_drop > (1.0 - margin) * first.predicted_drop &&
           std::ranges::find(first.family, effect.name) != first.family.end();
  });
  if (preferred != effects.end()) std::rotate(effects.begin(), preferred, preferred + 1);
}

/// The best of what was found that a real fit bears out.
void Recipe::advise() {
  constexpr std::size_t most_fitted = 3;
  std::size_t fitted = 0;
  for (const EffectFinding& finding : result_.effects) {
    if (finding.status != FindingStatus::found || fitted++ == most_fitted) return;
    const std::string reason = reason_against(room_, finding, options_.least_visibility, pool_);
    if (reason.empty()) {
      result_.advice.effect = finding.name;
      return;
    }
    result_.advice.withheld.push_back(finding.name + ": " + reason);
  }
}

Diagnosis Recipe::run(const std::vector<std::string>& names) {
  if (room_.fit().layout.outputs.empty()) return result_;  // nothing is left to explain
  report_progress("fitting the noise", 0.0);
  null_ = find_null(room_.fit());
  tangent_.compute(room_.fit().tangent);
  result_.residual = describe_residual(null_);
  result_.rmse = total_rmse(room_.fit().layout, room_.fit().residual);
  result_.floor = noise_floor(room_.fit().layout, null_.best.noise);
  make(names);
  screen_all(trials_);
  test_best(trials_, most_tested);
  result_.effects = judge(trials_, 0.0);
  const auto is_found = [](const EffectFinding& finding) {
    return finding.status == FindingStatus::found;
  };
  const auto is_slow_change = [](const EffectFinding& finding) {
    return finding.status == FindingStatus::slow_change;
  };
  if (std::ranges::none_of(result_.effects, is_found)) try_pairs(result_.effects);
  report_progress("looking for structure", 0.0);
  if (std::ranges::any_of(result_.effects, is_found)) {
    result_.verdict = Verdict::effect_missing;
    report_progress("fitting what was found", 0.0);
    rank_by_fits();
    prefer_known();
    for (const Trial& trial : trials_) {
      if (trial.candidate.name == result_.effects.front().name) {
        result_.floor = std::min(result_.floor, trial.floor);
      }
    }
    advise();
  } else {
    result_.omnibus = test_for_structure(room_, fitted_.kit, null_, options_, pool_);
    if (result_.omnibus.p_value < options_.unexplained_below) {
      result_.verdict = Verdict::unexplained;
    } else if (std::ranges::any_of(result_.effects, is_slow_change)) {
      result_.verdict = Verdict::slow_change;
    }
  }
  result_.limits = find_limits(room_, fitted_.kit, null_, options_.significance, trials_.size());
  return result_;
}

}  // namespace

Diagnosis diagnose(const DiagnosedFit& fitted, const std::vector<std::string>& candidates,
                   const DiagnosisOptions& options) {
  return Recipe(fitted, options).run(candidates);
}

}  // namespace sepcal
