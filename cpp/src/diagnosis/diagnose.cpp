// SPDX-License-Identifier: BSD-3-Clause
// The recipe in order: make the candidates, screen all of them, test those near the top, calibrate
// what slow noise could imitate, hold rows out, correct for their number; pairs where no
// single one passes; and where nothing does, whether anything is there.
#include <algorithm>
#include <cmath>
#include <mutex>

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
constexpr std::size_t most_simulated = 3;  // the others are corrected as the worst of these
constexpr std::size_t most_pairs_tested = 5;

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
    if (trial.tested && trial.log10_p < threshold) significant.push_back(&trial);
  }
  std::ranges::stable_sort(significant, {}, &Trial::log10_p);
  Inflation worst;
  for (std::size_t i = 0; i < significant.size(); ++i) {
    report_progress("calibrating tests",
                    static_cast<double>(i) / static_cast<double>(significant.size()));
    Inflation inflation = worst;
    if (i < most_simulated) {
      const bool beyond_doubt = significant[i]->log10_p < doubtless;
      const int simulations =
          beyond_doubt ? std::min(few_simulations, options_.simulations) : options_.simulations;
      inflation =
          simulate_inflation(room_, null_, *significant[i], simulations, options_.seed, pool_);
      worst = {std::max(worst.median, inflation.median),
               std::max(worst.ninetieth, inflation.ninetieth)};
    }
    inflate(inflation, *significant[i]);
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
      if (finding.p_adjusted < options_.significance && finding.held_out_passed) {
        finding.status = FindingStatus::found;
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
  if (std::ranges::none_of(result_.effects, is_found)) try_pairs(result_.effects);
  report_progress("looking for structure", 0.0);
  if (std::ranges::any_of(result_.effects, is_found)) {
    result_.verdict = Verdict::effect_missing;
    for (const Trial& trial : trials_) {
      if (trial.candidate.name == result_.effects.front().name) {
        result_.floor = std::min(result_.floor, trial.floor);
      }
    }
  } else {
    result_.omnibus = test_for_structure(room_, fitted_.kit, null_, options_, pool_);
    if (result_.omnibus.p_value < options_.unexplained_below) {
      result_.verdict = Verdict::unexplained;
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
