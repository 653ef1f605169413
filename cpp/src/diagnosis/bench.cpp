// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/bench.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>

#include "sepcal/error.hpp"

namespace sepcal::diagnosis {
namespace {

constexpr std::size_t most_confirmed = 3;
constexpr double doubtless = -30.0;  // log10 of a tail for which few simulations do
constexpr int few_simulations = 39;
constexpr std::size_t most_calibrated = 3;  // the others are corrected as the worst of these

}  // namespace

using Eigen::Index;

bool may_be_slow(const Trial& trial, double threshold) {
  return trial.tested && trial.slow && trial.tails.beside < threshold;
}

std::vector<std::size_t> best_of(const Trials& trials, std::size_t most,
                                 const std::function<bool(const Trial&)>& counts) {
  std::vector<std::size_t> chosen;
  for (double Trial::* const by : {&Trial::log10_white, &Trial::log10_plain}) {
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

Bench::Bench(const DiagnosedFit& fitted, const DiagnosisOptions& options, base::ThreadPool& pool)
    : Bench(fitted, {}, options, pool) {}

Bench::Bench(const DiagnosedFit& fitted, const Candidate& released, const DiagnosisOptions& options,
             base::ThreadPool& pool)
    : fitted_(fitted),
      options_(options),
      pool_(pool),
      room_(fitted, released, pool),
      refits_(std::make_unique<Refits>(room_)) {
  if (is_exact()) return;
  room_.add_wandering();
  room_.orthonormalise();
  null_ = find_null(room_.fit());
  if (room_.follows_path()) return;
  instruments_ = std::make_unique<InstrumentNoise>(room_, fitted.kit, null_, options.wanders);
}

DiagnosisWork Bench::work() const {
  DiagnosisWork all = work_;
  all.refitted += refits_->count();
  return all;
}

void Bench::report_progress(std::string_view task, double fraction) const {
  if (options_.progress) options_.progress(task, fraction);
}

Trials Bench::make(const std::vector<std::string>& names) {
  Trials trials;
  for (const std::string& name : names) {
    try {
      Trial trial{.candidate = room_.make(name)};
      const bool twice = std::ranges::any_of(
          trials, [&](const Trial& other) { return other.candidate.name == trial.candidate.name; });
      if (!twice) trials.push_back(std::move(trial));
    } catch (const Error&) {
      continue;  // the record doesn't have what it takes
    }
  }
  return trials;
}

void Bench::screen_all(Trials& trials) const {
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

void Bench::test_best(Trials& trials, std::size_t most) const {
  const std::vector<std::size_t> chosen =
      best_of(trials, most, [](const Trial& trial) { return trial.visible; });
  work_.tested += chosen.size();
  std::mutex mutex;
  double done = 0.0;
  pool_.for_each(chosen.size(), [&](std::size_t k) {
    test(room_, null_, trials[chosen[k]]);
    const std::lock_guard lock(mutex);
    report_progress("testing effects", ++done / static_cast<double>(chosen.size()));
  });
  bound_tested(trials);
}

/// What noise as instruments have it makes of those tested. Noise is what is left beside the best
/// of them, but for functions of time of any form, which would take it for theirs.
void Bench::bound_tested(Trials& trials) const {
  constexpr std::size_t most_beside = 6;
  constexpr Index rows_a_column = 20;
  if (!instruments_) return;
  std::vector<Trial*> tested;
  std::vector<Columns> bases;
  for (Trial& trial : trials) {
    if (!trial.tested) continue;
    tested.push_back(&trial);
    bases.push_back(project_trial(room_, null_, trial, trial.shape).basis);
  }
  std::vector<std::size_t> order(tested.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return tested[i]->log10_plain; });
  Columns beside;
  std::size_t taken = 0;
  for (const std::size_t i : order) {
    const Index columns = beside.cols() + bases[i].cols();
    if (is_flexible_in_time(tested[i]->candidate)) continue;
    if (rows_a_column * columns > room_.fit().layout.count()) continue;
    beside = join(beside, bases[i]);
    if (++taken == most_beside) break;
  }
  instruments_->set_beside(beside);
  const std::vector<InstrumentTail> tails = instruments_->tails(bases);
  for (std::size_t i = 0; i < tested.size(); ++i) bound(tails[i], *tested[i]);
}

void Bench::hold_out_significant(Trials& trials) const {
  const double threshold = std::log10(options_.significance);
  constexpr double much = 0.1;  // of the error, by one step
  pool_.for_each(trials.size(), [&](std::size_t i) {
    Trial& trial = trials[i];
    if (trial.tested ||
        (trial.visible && (trial.log10_p < threshold || trial.predicted_drop > much))) {
      hold_out(room_, null_, trial);
    }
  });
}

void Bench::calibrate_significant(Trials& trials, double threshold) const {
  std::vector<Trial*> significant;
  for (Trial& trial : trials) {
    if (!trial.tested) continue;
    const bool is_sure = trial.log10_p < threshold;
    if (is_sure ? !is_decided_by_bounds(trial) : may_be_slow(trial, threshold)) {
      significant.push_back(&trial);
    }
  }
  std::ranges::stable_sort(significant, {}, &Trial::log10_p);
  double worst = 1.0;  // of what is left of a log10 p
  for (std::size_t i = 0; i < significant.size(); ++i) {
    report_progress("calibrating tests",
                    static_cast<double>(i) / static_cast<double>(significant.size()));
    Trial& trial = *significant[i];
    const double plain = trial.tails.log10_p();
    if (i < most_calibrated) {
      const bool beyond_doubt = plain < doubtless;
      const int draws =
          beyond_doubt ? std::min(few_simulations, options_.simulations) : options_.simulations;
      ++work_.calibrated;
      calibrate(room_, null_, draws, options_.seed, pool_, trial);
      if (plain < 0.0) worst = std::min(worst, trial.tails.log10_p() / plain);
    } else {
      trial.tails = {worst * trial.tails.either, worst * trial.tails.beside};
      combine_tails(trial);
    }
  }
  for (Trial* trial : significant) doubt(room_, null_, *trial);
  double least_sure = -infinity;
  for (const Trial& trial : trials) {
    if (trial.tested) least_sure = std::max(least_sure, trial.log10_p);
  }
  for (Trial& trial : trials) {
    if (trial.visible && !trial.tested) trial.log10_p = std::max(trial.log10_p, least_sure);
  }
}

void Bench::confirm_best(Trials& trials, double threshold) const {
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
