// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/alternatives.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <tuple>
#include <utility>

#include "diagnosis/finding.hpp"
#include "diagnosis/projection.hpp"
#include "diagnosis/refits.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t most_fitted = 5;
constexpr double worth_a_fit = 0.01;     // p, of what was not found
constexpr double hardly_more = 1.1;      // of the error on rows held out
constexpr double about = 1.05;           // likewise, beside far more coefficients
constexpr std::size_t most_beside = 12;  // asked beside the first
constexpr double counts_below = 0.01;    // p beside the first, over their number

using Findings = std::vector<EffectFinding>;

bool may_stand_first(const EffectFinding& finding) {
  return finding.status == FindingStatus::found ||
         (finding.status != FindingStatus::cannot_be_seen && finding.p_value < worth_a_fit);
}

/// In turn the surest, and those that take most of the error on rows held out: noise may make much
/// of what explains little.
std::vector<const EffectFinding*> choose_alternatives(const Findings& findings) {
  std::vector<const EffectFinding*> by_order;
  for (const EffectFinding& finding : findings) {
    if (may_stand_first(finding)) by_order.push_back(&finding);
  }
  std::vector<const EffectFinding*> by_gain = by_order;
  std::ranges::stable_sort(by_gain, {}, [](const EffectFinding* one) { return left_out(*one); });
  std::vector<const EffectFinding*> chosen;
  for (std::size_t i = 0; i < by_order.size() && chosen.size() < most_fitted; ++i) {
    for (const EffectFinding* next : {by_gain[i], by_order[i]}) {
      if (chosen.size() == most_fitted) break;
      if (std::ranges::find(chosen, next) == chosen.end()) chosen.push_back(next);
    }
  }
  return chosen;
}

/// The alternatives, and one more: the line along the channel of one that is a function of any
/// form, if it was found.
std::vector<Alternative> join_line(CandidateRoom& room, const Findings& findings) {
  std::vector<Alternative> asked;
  for (const EffectFinding* finding : choose_alternatives(findings)) {
    asked.push_back({room.make(finding->name), shape_of(*finding)});
  }
  for (const EffectFinding& finding : findings) {
    if (finding.status != FindingStatus::found) continue;
    const Candidate& line = room.make(finding.name);
    const bool is_asked = std::ranges::any_of(
        asked, [&](const Alternative& one) { return one.candidate.name == finding.name; });
    const bool is_of_one = std::ranges::any_of(
        asked, [&](const Alternative& one) { return is_line_of(line, one.candidate, true); });
    if (is_asked || !is_of_one) continue;
    asked.push_back({line, shape_of(finding)});
    break;
  }
  return asked;
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

/// The noise that is left beside all of them at once, by one step: what is judged in it must not
/// bring a noise that swallows what it leaves. Of short records that beside the first.
NoiseMembers noise_beside(const CandidateTesting& testing, const std::vector<Alternative>& asked) {
  constexpr Index fewest_rows = 10;  // a column
  const CandidateRoom& room = testing.room();
  Columns columns;
  for (const Alternative& alternative : asked) {
    if (is_flexible_in_time(alternative.candidate)) continue;
    const Columns G = room.columns(alternative.candidate, alternative.shape).whole;
    const Index rows_needed = fewest_rows * (columns.cols() + G.cols());
    if (columns.cols() > 0 && rows_needed > room.fit().layout.count()) break;
    columns = join(columns, G);
  }
  return testing.null().test->compare(span_beyond(testing.null().basis, columns)).with.noise;
}

/// -2 ln L in a noise that is known, but for a constant, one step from a fit: as instruments have
/// it, or where the log's is none of these, the one given; minus infinity where that leaves nothing
/// of an output.
double minus_two_log_likelihood(const CandidateTesting& testing, const NoiseMembers& noise,
                                const CandidateRoom& room) {
  const InstrumentNoise* instruments = testing.instruments();
  if (instruments && instruments->knows_the_noise()) {
    return instruments->minus_two_log_likelihood(room.fit());
  }
  const RowLayout& layout = room.fit().layout;
  const RowLayout& known = testing.room().fit().layout;
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
      testing.null().test->products(noise, in_units_of_noise(tangent.columns()), residual);
  return products_beyond(products, tangent.rank())(0, 0);
}

/// What another fit to the same rows takes of the residual; empty where it leaves nothing of an
/// output.
VectorXd taken_of_residual(const LinearisedFit& without, const LinearisedFit& with) {
  if (with.layout.outputs.size() != without.layout.outputs.size()) return {};
  VectorXd taken = without.residual;
  for (std::size_t j = 0; j < without.layout.outputs.size(); ++j) {
    const Index first = without.layout.first(j);
    const Index rows = without.layout.rows;
    const double units = with.layout.outputs[j].scale / without.layout.outputs[j].scale;
    taken.segment(first, rows) -= units * with.residual.segment(first, rows);
  }
  return taken;
}

/// Whether two fits take the same of the residual, to an angle.
bool is_alike(const Alternative& one, const Alternative& other, double cosine = alike) {
  if (one.taken.size() == 0 || one.taken.size() != other.taken.size()) return false;
  return one.taken.dot(other.taken) > cosine * one.taken.norm() * other.taken.norm();
}

/// Whether both are lags that take much the same: an inertial unit that is late and an attitude
/// that is early by as much differ by what the accelerometers say alone, and a likelihood knows
/// that no better than the noise.
bool are_one_lag(const Alternative& one, const Alternative& other) {
  constexpr double much_the_same = 0.5;
  return is_lag(one.candidate) && is_lag(other.candidate) && is_alike(one, other, much_the_same);
}

/// The most that what comes first may leave of the error on rows held out, beside what others
/// leave: noise remembers, and rows that are far apart do not. Functions of time of any form
/// foretell noise that wanders as well, and count where they leave less than half.
double most_left_out(const std::vector<const Alternative*>& found,
                     const std::function<double(const Alternative*)>& error_left) {
  constexpr double less_than_half = 0.45;
  double most = infinity;
  for (const Alternative* alternative : found) {
    const double share =
        is_flexible_in_time(alternative->candidate) ? less_than_half : clearly_less;
    most = std::min(most, error_left(alternative) / share);
  }
  return most;
}

/// Whether one asks for no more effects or coefficients than another, and for fewer of these or a
/// simpler form.
bool is_simpler(const Candidate& one, const Candidate& other) {
  const auto [effects, form, coefficients] = complexity_of(one);
  const auto [other_effects, other_form, other_coefficients] = complexity_of(other);
  if (effects > other_effects || coefficients > other_coefficients) return false;
  return coefficients < other_coefficients || form < other_form;
}

/// Whether a single effect is a function of one of the pair's channels, at the same port.
bool bends_one_of(const Candidate& pair, const Candidate& single) {
  if (pair.settings.size() < 2 || single.settings.size() != 1) return false;
  const EffectName curve = parse_effect_name(single.settings.front().name);
  return std::ranges::any_of(pair.settings, [&](const EffectSetting& setting) {
    const EffectName line = parse_effect_name(setting.name);
    return !line.base.empty() && line.base == curve.base && line.port == curve.port;
  });
}

/// Whether the one follows a channel that can't be the cause, the other at its port one that can.
bool is_stand_in_for(const Candidate& one, const Candidate& other) {
  if (!one.stands_in || other.stands_in || one.settings.size() != 1) return false;
  const std::string port = parse_effect_name(one.settings.front().name).port;
  return other.settings.size() == 1 && parse_effect_name(other.settings.front().name).port == port;
}

EffectFinding& finding_of(Findings& findings, const std::string& name) {
  const auto finding = std::ranges::find(findings, name, &EffectFinding::name);
  if (finding == findings.end()) throw Error("nothing is known of the alternative " + name);
  return *finding;
}

}  // namespace

double error_left(const Alternative& alternative, const EffectFinding& finding) {
  return std::max(left_out(finding), 1.0 - alternative.drop);
}

bool is_far_simpler(const Candidate& one, const Candidate& other) {
  return 3 * one.coefficients.size() <= other.coefficients.size();
}

double schwarz_penalty(const Candidate& candidate, Index measurements) {
  const double each = std::log(static_cast<double>(measurements));
  std::size_t thresholds = 0;  // each chosen among the rows, as a step's time is
  for (const EffectSetting& setting : candidate.settings) {
    thresholds += parse_effect_name(setting.name).thresholds.size();
  }
  return each * static_cast<double>(candidate.coefficients.size()) +
         2.0 * each * static_cast<double>(thresholds) + 2.0 * std::log(candidate.shape.tried);
}

void fit_all(const CandidateTesting& testing, const NoiseMembers& noise,
             std::vector<Alternative>& asked) {
  testing.pool().for_each(asked.size(), [&](std::size_t i) {
    Alternative& alternative = asked[i];
    try {
      alternative.fit = testing.refits().with(alternative.candidate, alternative.shape);
      base::ThreadPool alone(1);
      const DiagnosedFit fitted =
          with_candidate(testing.fitted(), alternative.candidate, alternative.fit);
      const CandidateRoom with(fitted, alone);
      alternative.minus_two_log_likelihood = minus_two_log_likelihood(testing, noise, with);
      alternative.taken = taken_of_residual(testing.room().fit(), with.fit());
      if (alternative.taken.size() > 0) {
        const LinearisedFit& before = testing.room().fit();
        alternative.drop = 1.0 - total_rmse(before.layout, before.residual - alternative.taken) /
                                     total_rmse(before.layout, before.residual);
      }
      alternative.criterion =
          alternative.minus_two_log_likelihood +
          schwarz_penalty(alternative.candidate, testing.room().fit().layout.count());
    } catch (const Error&) {
      alternative.criterion = alternative.minus_two_log_likelihood = infinity;
    }
  });
}

ModelSelection fit_alternatives(CandidateTesting& testing, const Findings& findings) {
  ModelSelection selection{.alternatives = join_line(testing.room(), findings)};
  selection.noise = noise_beside(testing, selection.alternatives);
  fit_all(testing, selection.noise, selection.alternatives);
  return selection;
}

const Alternative* put_first(const ModelSelection& selection,
                             const std::vector<std::string>& preferred, Findings& findings) {
  for (EffectFinding& finding : findings) {
    if (finding.beside == Beside::equivalent) finding.beside = Beside::untried;
  }
  std::vector<const Alternative*> found;
  for (const Alternative& alternative : selection.alternatives) {
    if (alternative.criterion == infinity) continue;
    if (finding_of(findings, alternative.candidate.name).status == FindingStatus::found) {
      found.push_back(&alternative);
    }
  }
  if (found.empty()) return nullptr;
  const auto error_left = [&](const Alternative* alternative) {
    return diagnosis::error_left(*alternative, finding_of(findings, alternative->candidate.name));
  };
  const double most = most_left_out(found, error_left);
  const auto speaks_for = [&](const Alternative* line, const Alternative* curve) {
    return is_line_of(line->candidate, curve->candidate, true) &&
           does_nearly_as_well(error_left(line), error_left(curve));
  };
  const std::vector<const Alternative*> all = found;
  std::erase_if(found, [&](const Alternative* one) {
    return error_left(one) > most && std::ranges::none_of(all, [&](const Alternative* curve) {
             return error_left(curve) <= most && speaks_for(one, curve);
           });
  });
  const auto is_outdone = [&](const Alternative* one) {
    return std::ranges::any_of(found, [&](const Alternative* other) {
      if (bends_one_of(one->candidate, other->candidate) &&
          error_left(other) <= hardly_more * error_left(one)) {
        return true;  // one cause that is curved
      }
      if (speaks_for(other, one)) return true;  // which follows noise too
      if (is_stand_in_for(one->candidate, other->candidate) &&
          does_nearly_as_well(error_left(other), error_left(one))) {
        return true;
      }
      const bool does_about_as_well = is_far_simpler(other->candidate, one->candidate) &&
                                      error_left(other) <= about * error_left(one) &&
                                      takes_nearly_all(error_left(other), error_left(one));
      return is_simpler(other->candidate, one->candidate) &&
             !is_stand_in_for(other->candidate, one->candidate) &&
             (does_about_as_well || error_left(other) <= error_left(one));
    });
  };
  std::vector<const Alternative*> standing;  // noise that nobody knows makes likelihoods sure
  std::ranges::remove_copy_if(found, std::back_inserter(standing), is_outdone);
  if (standing.empty()) standing = found;
  const auto most_likely_of = [&](const Alternative* alternative) {  // and of what it speaks for
    const Alternative* best = alternative;
    for (const Alternative* curve : found) {
      if (curve->criterion < best->criterion && speaks_for(alternative, curve)) best = curve;
    }
    return best;
  };
  const auto criterion = [&](const Alternative* alternative) {
    return most_likely_of(alternative)->criterion;
  };
  const Alternative* first = *std::ranges::min_element(standing, {}, criterion);
  const auto belief = [&](const Alternative* alternative) {
    const Candidate& candidate = alternative->candidate;
    const bool is_preferred = std::ranges::find(preferred, candidate.name) != preferred.end();
    auto complexity = complexity_of(candidate);  // two lines are simpler than any form of one
    if (is_of_lines(candidate, 2)) complexity = {1, 2, candidate.coefficients.size()};
    return std::tuple(complexity, candidate.stands_in, !is_preferred, criterion(alternative));
  };
  const double likely = criterion(first) + as_likely;
  const double left = hardly_more * error_left(first);
  for (const Alternative* alternative : standing) {
    const bool is_as_good = criterion(alternative) < likely && error_left(alternative) <= left;
    if (is_as_good && belief(alternative) < belief(first)) first = alternative;
  }
  const Alternative* curve = most_likely_of(first);  // itself, or one that it can't stand for alone
  for (const Alternative& alternative : selection.alternatives) {
    const double more = alternative.minus_two_log_likelihood - first->minus_two_log_likelihood;
    if (&alternative == first) continue;
    const bool is_likelier = &alternative == curve && more < -as_likely;
    const bool is_as_likely =
        std::abs(more) < as_likely && clearly_less * error_left(&alternative) <= error_left(first);
    const bool is_as_good = (is_alike(alternative, *first) || are_one_lag(alternative, *first)) &&
                            error_left(&alternative) <= left;
    if (!is_likelier && !is_as_likely && !is_as_good) continue;
    EffectFinding& finding = finding_of(findings, alternative.candidate.name);
    finding.beside = Beside::equivalent;
    if (is_lag(alternative.candidate)) {  // told beside the first's, which is a fit's
      Coefficient& lag = finding.coefficients.front();
      lag.estimate = alternative.fit[lag.name].value;
    }
  }
  std::ranges::stable_partition(findings, [](const EffectFinding& finding) {
    return finding.beside == Beside::equivalent && finding.status == FindingStatus::found;
  });
  const auto place = std::ranges::find(findings, first->candidate.name, &EffectFinding::name);
  std::rotate(findings.begin(), place, place + 1);
  return first;
}

void promise_by_fits(const CandidateTesting& testing, const ModelSelection& selection,
                     Findings& findings) {
  const CandidateRoom& room = testing.room();
  const bool by_filter =
      room.fitted().method == FitMethod::filter_error;  // in the noise of the fit
  if (!room.follows_path() || by_filter) return;
  for (const Alternative& alternative : selection.alternatives) {
    if (!std::isfinite(alternative.criterion)) continue;
    EffectFinding& finding = finding_of(findings, alternative.candidate.name);
    finding.predicted_drop = error_drop(room.fitted(), alternative.fit);
    finding.drop_is_fitted = true;
  }
}

const Objection& object(CandidateTesting& testing, ModelSelection& selection,
                        const EffectFinding& finding) {
  const auto known = selection.objections.find(finding.name);
  if (known != selection.objections.end()) return known->second;
  Objection objection =
      find_objection(testing.room(), testing.refits(), finding, testing.options().least_visibility);
  return selection.objections.emplace(finding.name, std::move(objection)).first->second;
}

void test_beside(CandidateTesting& testing, const Alternative& first, Findings& findings) {
  const DiagnosedFit fitted = with_candidate(testing.fitted(), first.candidate, first.fit);
  DiagnosisOptions options = testing.options();
  options.progress = {};
  std::vector<std::string> names;
  for (const EffectFinding& finding : findings) {
    if (names.size() == most_beside) break;
    if (finding.status != FindingStatus::found || finding.name == first.candidate.name) continue;
    if (finding.beside == Beside::untried) names.push_back(finding.name);
  }
  if (names.empty()) return;
  CandidateTesting beside(fitted, options, testing.pool());
  if (beside.is_exact()) return;
  Trials trials = beside.make(names);
  const double threshold = std::log10(counts_below / static_cast<double>(names.size()));
  beside.screen_all(trials);
  beside.test_best(trials, trials.size(), threshold, false);
  beside.hold_out_significant(trials, false);
  beside.calibrate_significant(trials, threshold, false);
  testing.count(beside.work());
  for (const Trial& trial : trials) {
    const bool counts = trial.visible && trial.log10_p < threshold && trial.held_out.judged &&
                        trial.held_out.passed;
    finding_of(findings, trial.candidate.name).beside = counts ? Beside::counts : Beside::fades;
  }
  order_by_beside(findings);
}

}  // namespace sepcal::diagnosis
