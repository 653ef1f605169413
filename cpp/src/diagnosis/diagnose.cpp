// SPDX-License-Identifier: BSD-3-Clause
// The recipe in order: make the candidates, screen all of them, test those near the top, calibrate
// what slow noise could imitate, hold rows out, correct for their number; where no single one
// passes those that a path has bent to, then pairs; and where nothing does, whether anything is
// there.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "diagnosis/bench.hpp"
#include "diagnosis/bent_effects.hpp"
#include "diagnosis/contenders.hpp"
#include "diagnosis/finding.hpp"
#include "diagnosis/omnibus.hpp"
#include "diagnosis/own_fit.hpp"
#include "diagnosis/pair_set.hpp"
#include "diagnosis/residual_noise.hpp"
#include "diagnosis/rivals.hpp"
#include "diagnosis/unlogged.hpp"
#include "numerics/selection.hpp"
#include "numerics/tails.hpp"

namespace sepcal {

using namespace diagnosis;  // this room's own

namespace {

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

double count_visible(const Trials& trials) {
  return static_cast<double>(std::ranges::count(trials, true, &Trial::visible));
}

/// Of an effect found among `number` that could have been.
double share_after_selection(const EffectFinding& finding, double significance, double number) {
  constexpr double beyond_doubt = 1e-60;
  if (finding.p_value < beyond_doubt) return 1.0;
  return numerics::share_after_selection(
      std::sqrt(numerics::chi_squared_point(finding.p_value, 1.0)),
      std::sqrt(numerics::chi_squared_point(significance / number, 1.0)));
}

class Recipe {
 public:
  Recipe(const DiagnosedFit& fitted, const DiagnosisOptions& options)
      : fitted_(fitted),
        options_(options),
        pool_(options.threads),
        bench_(fitted, options, pool_) {}

  Diagnosis run(const std::vector<std::string>& names);

 private:
  std::vector<EffectFinding> collect(const Trials& trials, double tests) const;
  /// `tests`: how many could have been chosen.
  std::vector<EffectFinding> judge(Trials& trials, double tests) const;
  /// Where a trial was made.
  const Bench& bench_of(const Trial& trial) const;
  bool has(FindingStatus status) const;
  double tests() const;
  void look_from_own_fits();
  void try_pairs();
  void settle();
  Objection object_to(const EffectFinding& finding);
  void advise();

  const DiagnosedFit& fitted_;
  const DiagnosisOptions& options_;
  base::ThreadPool pool_;
  Bench bench_;
  Trials trials_;
  std::map<std::string, std::unique_ptr<OwnFit>> own_fits_;  // of what a step did not find
  Contest contest_;
  Diagnosis result_;
};

const Bench& Recipe::bench_of(const Trial& trial) const {
  const auto own = own_fits_.find(trial.candidate.name);
  return own == own_fits_.end() ? bench_ : own->second->bench();
}

bool Recipe::has(FindingStatus status) const {
  return std::ranges::find(result_.effects, status, &EffectFinding::status) !=
         result_.effects.end();
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
    const Bench& bench = bench_of(trials[i]);
    EffectFinding finding = describe(bench.room(), trials[i]);
    finding.structure = structure_of(bench.null(), trials[i], options_.pse);
    if (v < visible.size() && visible[v] == i) {
      finding.p_adjusted = holm[v];
      finding.p_listed = listed[v];
      ++v;
      const auto number = static_cast<double>(log10_p.size());
      if (!finding.held_out_passed) {
        // whatever it is, it does not predict
      } else if (finding.p_adjusted < options_.significance) {
        finding.status = FindingStatus::found;
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

std::vector<EffectFinding> Recipe::judge(Trials& trials, double tests) const {
  bench_.hold_out_significant(trials);
  const double number = std::max({1.0, count_visible(trials), tests});
  const double threshold = std::log10(options_.significance / number) + 0.3;  // about Holm's
  bench_.calibrate_significant(trials, threshold);
  bench_.confirm_best(trials, threshold);
  std::vector<EffectFinding> findings = collect(trials, tests);
  rank(findings);
  return findings;
}

/// What the fit has bent its own parameters to is found where a fit that has it ends.
void Recipe::look_from_own_fits() {
  bench_.report_progress("fitting what may be hidden", 0.0);
  const double number = std::max(1.0, tests());
  for (std::unique_ptr<OwnFit>& own : find_hidden(bench_, trials_)) {
    Trial found = own->test(std::log10(options_.significance / number) + 0.3);
    Trial& trial = *std::ranges::find_if(
        trials_, [&](const Trial& other) { return other.candidate.name == found.candidate.name; });
    if (!found.visible || !(found.log10_p < trial.log10_p)) continue;
    own_fits_.emplace(found.candidate.name, std::move(own));
    trial = std::move(found);
  }
  result_.effects = collect(trials_, number);
  rank(result_.effects);
}

void Recipe::try_pairs() {
  std::vector<std::string> best;
  double visible = 0.0;
  for (const EffectFinding& finding : result_.effects) {
    if (finding.status == FindingStatus::cannot_be_seen) continue;
    ++visible;
    if (best.size() < most_paired && finding.shapes.empty()) best.push_back(finding.name);
  }
  std::vector<std::string> names;
  for (std::size_t a = 0; a < best.size(); ++a) {
    for (std::size_t b = a + 1; b < best.size(); ++b) names.push_back(best[a] + "+" + best[b]);
  }
  Trials pairs = bench_.make(names);
  bench_.screen_all(pairs);
  bench_.test_best(pairs, most_pairs_tested);
  // The ten were chosen by what they explain: every pair of all candidates could have been.
  const double tests = 0.5 * (visible + static_cast<double>(options_.others)) * (visible - 1.0);
  std::vector<EffectFinding> findings = judge(pairs, tests);
  std::erase_if(findings,
                [](const EffectFinding& pair) { return pair.status != FindingStatus::found; });
  result_.effects.insert(result_.effects.begin(), findings.begin(), findings.end());
}

/// The order of what was found, and what becomes of the others beside the first: by real fits.
void Recipe::settle() {
  bench_.report_progress("fitting what was found", 0.0);
  contest_ = fit_contenders(bench_, result_.effects);
  admit_bent(bench_, contest_, result_.effects);
  const Contender* first = put_first(contest_, options_.preferred, result_.effects);
  promise_by_fits(bench_, contest_, result_.effects);
  if (first) test_beside(bench_, *first, result_.effects);
  result_.pairs = keep_as_likely(bench_, contest_, find_pair_set(bench_, trials_, contest_.noise));
  for (const Trial& trial : trials_) {
    if (trial.candidate.name == result_.effects.front().name) {
      result_.floor = std::min(result_.floor, trial.floor);
    }
  }
}

Objection Recipe::object_to(const EffectFinding& finding) {
  Objection objection = object(bench_, contest_, finding);
  if (objection.reason.empty()) {
    objection.reason = find_rival(bench_, contest_, finding, result_.effects);
  }
  return objection;
}

/// The best of what was found that a real fit bears out and no other contradicts.
void Recipe::advise() {
  constexpr std::size_t most_fitted = 3;
  std::size_t fitted = 0;
  bool first_stands = false;  // though no fit takes it
  for (EffectFinding& finding : result_.effects) {
    if (finding.status != FindingStatus::found || fitted == most_fitted) return;
    if (finding.beside == Beside::fades) continue;  // what it explains is the first's
    if (first_stands && finding.beside == Beside::counts) continue;  // alone it would stand in
    const Objection objection = object_to(finding);
    if (std::isfinite(objection.drop)) {
      finding.predicted_drop = objection.drop;
      finding.drop_is_fitted = true;
      result_.floor = std::min(result_.floor, result_.rmse * (1.0 - objection.drop));
    }
    if (objection.reason.empty()) {
      result_.advice.effect = finding.name;
      return;
    }
    if (fitted == 0) first_stands = objection.is_to_fit;
    ++fitted;
    result_.advice.withheld.push_back(finding.name + ": " + objection.reason);
  }
}

Diagnosis Recipe::run(const std::vector<std::string>& names) {
  result_.pse = options_.pse;
  if (bench_.is_exact()) return result_;  // nothing is left to explain
  const CandidateRoom& room = bench_.room();
  result_.residual = describe_residual(bench_.null());
  result_.rmse = total_rmse(room.fit().layout, room.fit().residual);
  result_.unit = common_unit(room.fit().layout);
  result_.floor = noise_floor(room.fit().layout, bench_.null().best.noise);
  if (!options_.only.empty()) {
    for (const std::string& name : names) bench_.room().make(name);  // or the reason is thrown
  }
  trials_ = bench_.make(names);
  bench_.screen_all(trials_);
  bench_.test_best(trials_, most_tested);
  result_.effects = judge(trials_, tests());
  if (!has(FindingStatus::found) && room.follows_path()) look_from_own_fits();
  if (!has(FindingStatus::found)) try_pairs();
  if (has(FindingStatus::found)) {
    result_.verdict = Verdict::effect_missing;
    settle();
    advise();
  } else {
    bench_.report_progress("looking for structure", 0.0);
    result_.omnibus =
        test_for_structure(bench_.room(), fitted_.kit, bench_.null(), options_, pool_);
    result_.unlogged = find_unlogged(room, bench_.null(), options_.seed);
    correct_together(options_.unexplained_below, result_.omnibus, result_.unlogged);
    if (result_.omnibus.significant || !result_.unlogged.empty()) {
      result_.verdict = Verdict::unexplained;
    } else if (has(FindingStatus::slow_change)) {
      result_.verdict = Verdict::slow_change;
    }
  }
  result_.limits =
      find_limits(bench_.room(), fitted_.kit, bench_.null(), options_.significance, trials_.size());
  return result_;
}

}  // namespace

Diagnosis diagnose(const DiagnosedFit& fitted, const std::vector<std::string>& candidates,
                   const DiagnosisOptions& options) {
  return Recipe(fitted, options).run(candidates);
}

}  // namespace sepcal
