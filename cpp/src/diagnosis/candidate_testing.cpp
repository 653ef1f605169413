// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/candidate_testing.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

constexpr std::size_t most_confirmed = 3;
constexpr std::size_t most_calibrated = 2;  // the others are corrected as the worst of these

}  // namespace

using Eigen::Index;

bool may_be_slow(const Trial& trial, double threshold) {
  return trial.tested && trial.slow && trial.tails.beside < threshold;
}

std::vector<std::size_t> best_of(const Trials& trials, std::size_t most,
                                 const std::function<bool(const Trial&)>& counts,
                                 std::initializer_list<double Trial::*> tails) {
  std::vector<std::size_t> chosen;
  for (double Trial::* const by : tails) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (counts(trials[i])) order.push_back(i);
    }
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return trials[i].*by; });
    if (order.size() > most) order.resize(most);
    for (const std::size_t i : order) {
      if (std::ranges::find(chosen, i) == chosen.end()) chosen.push_back(i);
    }
  }
  return chosen;
}

CandidateTesting::CandidateTesting(const DiagnosedFit& fitted, const DiagnosisOptions& options,
                                   base::ThreadPool& pool)
    : CandidateTesting(fitted, {}, options, pool) {}

CandidateTesting::CandidateTesting(const DiagnosedFit& fitted, const Candidate& released,
                                   const DiagnosisOptions& options, base::ThreadPool& pool)
    : fitted_(fitted),
      options_(options),
      pool_(pool),
      room_(fitted, released, pool,
            options.rule == DiagnosisRule::partial_f ? Regressors::unsmoothed : Regressors::read),
      refits_(std::make_unique<Refits>(room_)) {
  if (is_exact()) return;
  room_.add_input_drift();
  room_.orthonormalise();
  null_ = find_null(room_.fit());
  if (!room_.follows_path()) know_instruments();
}

CandidateTesting::CandidateTesting(const CandidateTesting& first, Regressors regressors)
    : fitted_(first.fitted_),
      options_(first.options_),
      pool_(first.pool_),
      room_(fitted_, {}, pool_, regressors),
      refits_(std::make_unique<Refits>(room_)) {
  room_.add_input_drift();
  room_.orthonormalise();
  null_ = find_null(room_.fit(), first.null_.whiteners);
  know_instruments();
}

void CandidateTesting::know_instruments() {
  instruments_ =
      std::make_unique<InstrumentNoise>(room_, fitted_.kit, null_, options_.error_budget);
  inputs_ = std::make_unique<InputNoise>(null_.white_outputs(), room_.input_columns());
}

DiagnosisWork CandidateTesting::work() const {
  DiagnosisWork all = work_;
  all.refitted += refits_->count();
  return all;
}

void CandidateTesting::report_progress(std::string_view task, double fraction) const {
  if (options_.progress) options_.progress(task, fraction);
}

Trials CandidateTesting::make(const std::vector<std::string>& names) {
  Trials trials;
  for (const std::string& name : names) {
    try {
      Trial trial{.candidate = room_.make(name)};
      const bool twice = std::ranges::any_of(trials, [&](const Trial& other) {
        return other.candidate.name == trial.candidate.name ||
               (!other.candidate.stepping_port.empty() &&  // under another name
                other.candidate.stepping_port == trial.candidate.stepping_port);
      });
      if (!twice) trials.push_back(std::move(trial));
    } catch (const Error&) {
      continue;  // the record doesn't have what it takes
    }
  }
  return trials;
}

void CandidateTesting::screen_all(Trials& trials) const {
  work_.screened += trials.size();
  std::mutex mutex;
  double done = 0.0;
  pool_.for_each(trials.size(), [&](std::size_t i) {
    trials[i].least_visibility = room_.visible_from(options_.least_visibility);
    screen(room_, null_, trials[i]);
    const std::lock_guard lock(mutex);
    report_progress("screening effects", ++done / static_cast<double>(trials.size()));
  });
}

void CandidateTesting::test_best(Trials& trials, std::size_t most, double threshold,
                                 bool slow_too) const {
  constexpr double worth_telling = 0.05;  // of the error, of a slow change
  std::vector<Trial*> chosen;
  for (const bool of_any_form : {false, true}) {  // which would leave no place to the others
    const auto counts = [&](const Trial& trial) {
      return trial.visible && is_of_any_form(trial.candidate) == of_any_form;
    };
    for (const std::size_t i : best_of(trials, most, counts)) {
      chosen.push_back(&trials[i]);
      chosen.back()->slow = is_slow(room_, chosen.back()->candidate, chosen.back()->shape);
    }
  }
  bound_all(chosen);
  double of_simple = worth_telling;
  for (const Trial* trial : chosen) {
    if (trial->slow && is_simple(trial->candidate)) {
      of_simple = std::max(of_simple, trial->predicted_drop);
    }
  }
  // Noise of free size is asked only where what instruments do leaves it open, and of a function of
  // any form only where it takes more than what is simple.
  std::erase_if(chosen, [&](Trial* trial) {
    if (!trial->bounded || !is_bounded(*trial)) return false;
    if (trial->bounded->log10_p / trial->inflation < threshold) return false;
    const double telling = is_simple(trial->candidate) ? worth_telling : of_simple;
    if (slow_too && trial->slow && trial->predicted_drop > telling) return false;
    trial->log10_p = trial->bounded->log10_p / trial->inflation;
    return true;
  });
  work_.tested += chosen.size();
  std::mutex mutex;
  double done = 0.0;
  pool_.for_each(chosen.size(), [&](std::size_t k) {
    test(room_, null_, *chosen[k]);
    const std::lock_guard lock(mutex);
    report_progress("testing effects", ++done / static_cast<double>(chosen.size()));
  });
}

/// What noise as instruments have it makes of them. Noise is what is left beside the best of them,
/// but for functions of time of any form, which would take it for theirs.
void CandidateTesting::bound_all(const std::vector<Trial*>& chosen) const {
  constexpr std::size_t most_beside = 6;
  constexpr Index rows_a_column = 20;
  if (!instruments_) return;
  struct AtShape {
    Trial* trial;
    double shape;
  };
  std::vector<AtShape> places;
  std::vector<Projection> projections;
  std::vector<Columns> bases;
  for (Trial* trial : chosen) {
    for (const double shape : best_shapes(*trial)) {
      places.push_back({trial, shape});
      projections.push_back(project_trial(room_, null_, *trial, shape));
      bases.push_back(projections.back().basis);
      trial->inflation =
          std::max(trial->inflation, inputs_->inflation(bases.back().dense(room_.fit().layout)));
    }
  }
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return places[i].trial->log10_plain; });
  Columns beside;
  std::vector<const Trial*> taken;
  for (const std::size_t i : order) {
    const Trial* trial = places[i].trial;
    const Index columns = beside.cols() + bases[i].cols();
    if (std::ranges::find(taken, trial) != taken.end()) continue;
    if (is_flexible_in_time(trial->candidate)) continue;
    if (rows_a_column * columns > room_.fit().layout.count()) continue;
    beside = join(beside, bases[i]);
    taken.push_back(trial);
    if (taken.size() == most_beside) break;
  }
  instruments_->set_beside(beside);
  const std::vector<InstrumentTail> tails = instruments_->tails(bases);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto [trial, shape] = places[i];
    const bool is_surer = bound(tails[i], *trial);
    if (is_surer && shape != trial->shape && is_decided_by_bounds(*trial)) {
      trial->shape = shape;
      estimate_plainly(room_.fit().layout, projections[i], null_.residual, *trial);
      trial->predicted_drop = predict_drop(null_, bases[i]);
    }
  }
}

void CandidateTesting::hold_out_significant(Trials& trials, bool promising_too) const {
  const double threshold = std::log10(options_.significance);
  constexpr double much = 0.07;  // of the error, by one step
  pool_.for_each(trials.size(), [&](std::size_t i) {
    Trial& trial = trials[i];
    const bool is_promising = promising_too && trial.predicted_drop > much;
    if (trial.tested || (trial.visible && (trial.log10_p < threshold || is_promising))) {
      hold_out(room_, null_, trial);
    }
  });
}

void CandidateTesting::calibrate_significant(Trials& trials, double threshold,
                                             bool slow_too) const {
  std::vector<Trial*> significant;
  const auto is_sure = [&](const Trial& trial) { return trial.log10_p < threshold; };
  for (Trial& trial : trials) {
    if (!trial.tested) continue;
    const bool is_open =
        slow_too && trial.held_out.passed && may_be_slow(trial, threshold);  // a slow change
    if (is_sure(trial) ? !is_decided_by_bounds(trial) : is_open) significant.push_back(&trial);
  }
  std::ranges::stable_sort(significant, {}, &Trial::log10_p);
  double worst = 1.0;  // of what is left of a log10 p
  for (std::size_t i = 0; i < significant.size(); ++i) {
    report_progress("calibrating tests",
                    static_cast<double>(i) / static_cast<double>(significant.size()));
    Trial& trial = *significant[i];
    const double plain = trial.tails.log10_p();
    if (i < most_calibrated) {
      ++work_.calibrated;
      work_.drawn += static_cast<std::size_t>(options_.simulations);
      calibrate(
          room_, null_,
          {.draws = options_.simulations, .seed = options_.seed, .beside_alone = !is_sure(trial)},
          pool_, trial);
      if (plain < 0.0) worst = std::min(worst, trial.tails.log10_p() / plain);
    } else {
      trial.tails = {worst * trial.tails.either, worst * trial.tails.beside};
      combine_tails(trial);
    }
  }
  for (Trial* trial : significant) doubt(room_, null_, *trial);
  double least_sure = threshold;
  for (const Trial& trial : trials) {
    if (trial.tested || trial.bounded) least_sure = std::max(least_sure, trial.log10_p);
  }
  for (Trial& trial : trials) {
    const bool only_screened = trial.visible && !trial.tested && !trial.bounded;
    if (only_screened) trial.log10_p = std::max(trial.log10_p, least_sure);
  }
}

std::optional<double> CandidateTesting::bounded_tail(const std::string& name) {
  Trials trials = make({name});
  screen_all(trials);
  if (trials.empty() || !trials.front().visible) return std::nullopt;
  bound_all({&trials.front()});
  const Trial& trial = trials.front();
  if (!trial.bounded) return std::nullopt;
  return trial.bounded->log10_p / trial.inflation;
}

void CandidateTesting::confirm_best(Trials& trials, double threshold) const {
  std::vector<Trial*> order;
  for (Trial& trial : trials) {
    if (trial.held_out.judged && trial.log10_p < threshold) order.push_back(&trial);
  }
  std::ranges::stable_sort(order, {}, &Trial::log10_p);
  std::size_t confirmed = 0;
  for (Trial* trial : order) {
    if (trial->held_out.passed || confirmed == most_confirmed) break;
    report_progress("fitting without some rows",
                    static_cast<double>(confirmed) / static_cast<double>(most_confirmed));
    confirm(*refits_, *trial);
    ++confirmed;
    if (trial->held_out.passed) break;
  }
}

}  // namespace sepcal::diagnosis
