// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/contenders.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <span>
#include <utility>

#include "diagnosis/projection.hpp"
#include "diagnosis/refits.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::size_t most_fitted = 8;
constexpr std::size_t most_pairs = 12;
constexpr double worth_a_fit = 0.01;     // p, of what was not found
constexpr double hardly_worse = 2.0;     // in the criterion
constexpr std::size_t most_beside = 12;  // asked beside the first
constexpr double counts_below = 0.01;    // p beside the first, over their number

using Findings = std::vector<EffectFinding>;

bool may_stand_first(const EffectFinding& finding) {
  return finding.status == FindingStatus::found ||
         (finding.status != FindingStatus::cannot_be_seen && finding.p_value < worth_a_fit);
}

/// Of what was found: the first, what would do as well, what counts beside it, the untried, the
/// rest. Within each as before.
void order_by_beside(Findings& findings) {
  const auto place = [&](const EffectFinding& finding) {
    if (finding.status != FindingStatus::found) return 5;
    if (&finding == &findings.front()) return 0;
    switch (finding.beside) {
      case Beside::equivalent:
        return 1;
      case Beside::counts:
        return 2;
      case Beside::untried:
        return 3;
      default:
        return 4;
    }
  };
  std::vector<std::pair<int, EffectFinding>> placed;
  for (const EffectFinding& finding : findings) placed.emplace_back(place(finding), finding);
  std::ranges::stable_sort(placed, {}, &std::pair<int, EffectFinding>::first);
  findings.clear();
  for (auto& [at, finding] : placed) findings.push_back(std::move(finding));
}

/// Whether it takes slow noise for its own, as functions of time of any form do.
bool is_flexible_in_time(const Candidate& candidate) {
  return std::ranges::any_of(candidate.effects, [](const Effect& effect) {
    return effect.driver && effect.driver->functions() > 1 && effect.driver->input() &&
           effect.driver->input()->name == "time";
  });
}

/// The noise that is left beside all of them at once, by one step: what is judged in it must not
/// bring a noise that swallows what it leaves. Of short records that beside the first.
NoiseMembers noise_beside(const Bench& bench, const std::vector<Contender>& asked) {
  constexpr Index fewest_rows = 10;  // a column
  const CandidateRoom& room = bench.room();
  Columns columns;
  for (const Contender& contender : asked) {
    if (is_flexible_in_time(contender.candidate)) continue;
    const Columns G = room.columns(contender.candidate, contender.shape).whole;
    const Index rows_needed = fewest_rows * (columns.cols() + G.cols());
    if (columns.cols() > 0 && rows_needed > room.fit().layout.count()) break;
    columns = join(columns, G);
  }
  return bench.null().test->compare(span_beyond(bench.null().basis, columns)).with.noise;
}

/// -2 ln L in a noise that is known, but for a constant, one step from a fit; minus infinity where
/// that leaves nothing of an output.
double minus_two_log_likelihood(const Bench& bench, const NoiseMembers& noise,
                                const DiagnosedFit& fitted) {
  base::ThreadPool alone(1);
  const CandidateRoom room(fitted, alone);
  const RowLayout& layout = room.fit().layout;
  const RowLayout& known = bench.room().fit().layout;
  if (layout.outputs.size() != known.outputs.size()) return -infinity;
  const auto in_units_of_noise = [&](const Columns& columns) -> Columns {
    return {columns.cols(), [&, columns](Index first, Eigen::Ref<MatrixXd> rows) {
              const auto j = static_cast<std::size_t>(first / layout.rows);
              columns.fill(first, rows);
              rows *= layout.outputs[j].scale / known.outputs[j].scale;
            }};
  };
  const TangentBasis tangent(room.fit());
  const MatrixXd residual = in_units_of_noise(view(room.fit().residual)).dense(layout);
  const MatrixXd products =
      bench.null().test->products(noise, in_units_of_noise(tangent.columns()), residual);
  return products_beyond(products, tangent.rank())(0, 0);
}

auto named(const std::string& name) {
  return [&name](const Contender& contender) { return contender.candidate.name == name; };
}

EffectFinding& finding_of(Findings& findings, const std::string& name) {
  return *std::ranges::find(findings, name, &EffectFinding::name);
}

}  // namespace

DiagnosedFit with_candidate(const DiagnosedFit& fitted, const Candidate& candidate, Fit fit) {
  DiagnosedFit next = fitted;
  next.effects.insert(next.effects.end(), candidate.settings.begin(), candidate.settings.end());
  next.fit = std::move(fit);
  return next;
}

double schwarz_penalty(const Candidate& candidate, Index measurements) {
  return static_cast<double>(candidate.coefficients.size()) *
             std::log(static_cast<double>(measurements)) +
         2.0 * std::log(candidate.shape.tried);
}

void fit_all(const Bench& bench, const NoiseMembers& noise, std::vector<Contender>& asked) {
  bench.pool().for_each(asked.size(), [&](std::size_t i) {
    Contender& contender = asked[i];
    try {
      contender.fit = refit_nearly(bench.room(), contender.candidate, contender.shape, enough_rows);
      contender.minus_two_log_likelihood = minus_two_log_likelihood(
          bench, noise, with_candidate(bench.fitted(), contender.candidate, contender.fit));
      contender.criterion = contender.minus_two_log_likelihood +
                            schwarz_penalty(contender.candidate, bench.room().fit().layout.count());
    } catch (const Error&) {
      contender.criterion = contender.minus_two_log_likelihood = infinity;
    }
  });
}

Contest fit_contenders(Bench& bench, const Findings& findings) {
  Contest contest;
  for (const EffectFinding& finding : findings) {
    if (contest.contenders.size() == most_fitted) break;
    if (!may_stand_first(finding)) continue;
    contest.contenders.push_back({bench.room().make(finding.name), shape_of(finding)});
  }
  contest.noise = noise_beside(bench, contest.contenders);
  fit_all(bench, contest.noise, contest.contenders);
  return contest;
}

std::vector<std::string> keep_as_likely(Bench& bench, const Contest& contest,
                                        const std::vector<Pair>& pairs) {
  std::vector<Contender> fitted;
  for (const Pair& pair : pairs) {
    if (fitted.size() == most_pairs) break;
    try {
      fitted.push_back({bench.room().make(pair.name), pair.shape});
    } catch (const Error&) {
      continue;  // the two can't stand in one model
    }
  }
  fit_all(bench, contest.noise, fitted);
  double least = infinity;
  for (const std::span<const Contender> all :
       {std::span(contest.contenders), std::span(std::as_const(fitted))}) {
    for (const Contender& contender : all) least = std::min(least, contender.criterion);
  }
  const auto alone = [&](const std::string& name) {
    const auto single = std::ranges::find_if(contest.contenders, named(name));
    return single == contest.contenders.end() ? infinity : single->criterion;
  };
  std::vector<std::string> kept;
  for (const Contender& pair : fitted) {
    const std::vector<std::string> members = split_effects(pair.candidate.name);
    const double single = std::ranges::min(members | std::views::transform(alone));
    if (pair.criterion < std::min(least + as_likely, single)) kept.push_back(pair.candidate.name);
  }
  return kept;
}

const Contender* put_first(const Contest& contest, const std::vector<std::string>& preferred,
                           Findings& findings) {
  const Contender* first = nullptr;
  const auto offer = [&](const Contender& contender, double margin) {
    if (finding_of(findings, contender.candidate.name).status != FindingStatus::found) return;
    const double least = first ? first->criterion + margin : infinity;
    if (contender.criterion < least) first = &contender;
  };
  for (const Contender& contender : contest.contenders) offer(contender, 0.0);
  if (!first) return nullptr;
  const auto is_preferred = [&](const std::string& name) {
    return std::ranges::find(preferred, name) != preferred.end();
  };
  for (const Contender& contender : contest.contenders) {
    if (is_preferred(first->candidate.name)) break;
    if (is_preferred(contender.candidate.name)) offer(contender, hardly_worse);
  }
  for (const Contender& contender : contest.contenders) {
    const double more = contender.minus_two_log_likelihood - first->minus_two_log_likelihood;
    if (&contender == first || !(std::abs(more) < as_likely)) continue;
    finding_of(findings, contender.candidate.name).beside = Beside::equivalent;
  }
  std::ranges::stable_partition(findings, [](const EffectFinding& finding) {
    return finding.beside == Beside::equivalent && finding.status == FindingStatus::found;
  });
  const auto place = std::ranges::find(findings, first->candidate.name, &EffectFinding::name);
  std::rotate(findings.begin(), place, place + 1);
  return first;
}

void promise_by_fits(const Bench& bench, const Contest& contest, Findings& findings) {
  const CandidateRoom& room = bench.room();
  const bool by_filter = room.fitted().by == FitMethod::filter_error;  // in the noise of the fit
  if (!room.follows_path() || by_filter) return;
  for (const Contender& contender : contest.contenders) {
    if (!std::isfinite(contender.criterion)) continue;
    EffectFinding& finding = finding_of(findings, contender.candidate.name);
    finding.predicted_drop = error_drop(room.fitted(), contender.fit);
    finding.drop_is_fitted = true;
  }
}

const Objection& object(Bench& bench, Contest& contest, const EffectFinding& finding) {
  const auto known = contest.objections.find(finding.name);
  if (known != contest.objections.end()) return known->second;
  Objection objection =
      find_objection(bench.room(), finding, bench.options().least_visibility, bench.pool());
  return contest.objections.emplace(finding.name, std::move(objection)).first->second;
}

void test_beside(Bench& bench, const Contender& first, Findings& findings) {
  const DiagnosedFit fitted = with_candidate(bench.fitted(), first.candidate, first.fit);
  DiagnosisOptions options = bench.options();
  options.progress = {};
  std::vector<std::string> names;
  for (const EffectFinding& finding : findings) {
    if (names.size() == most_beside) break;
    if (finding.status != FindingStatus::found || finding.name == first.candidate.name) continue;
    if (finding.beside == Beside::untried) names.push_back(finding.name);
  }
  if (names.empty()) return;
  Bench beside(fitted, options, bench.pool());
  if (beside.is_exact()) return;
  Trials trials = beside.make(names);
  const double threshold = std::log10(counts_below / static_cast<double>(names.size()));
  beside.screen_all(trials);
  beside.test_best(trials, trials.size());
  beside.hold_out_significant(trials);
  beside.calibrate_significant(trials, threshold);
  for (const Trial& trial : trials) {
    const bool counts = trial.visible && trial.log10_p < threshold && trial.held_out.judged &&
                        trial.held_out.passed;
    finding_of(findings, trial.candidate.name).beside = counts ? Beside::counts : Beside::fades;
  }
  order_by_beside(findings);
}

}  // namespace sepcal::diagnosis
