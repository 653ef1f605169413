// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/stage_two.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

#include "estimation/alternation.hpp"
#include "estimation/likelihood.hpp"

namespace sepcal::estimation {
namespace {

// First radii. One over them is Marquardt's damping of columns of unit length.
constexpr double gauss_newton = 1e4;  // the first step is all but Gauss-Newton's
constexpr double customary = 1e3;     // a damping of 0.001, the customary first one
constexpr double short_steps = 10.0;
constexpr double within_the_basin = 0.1;  // a fraction of Gauss-Newton's, as in stage one

/// A loss is minimised jointly.
SecondStage possible(const FitOptions& options, SecondStage method) {
  return options.loss == Loss::squares ? method : SecondStage::joint;
}

/// The turns of an attempt: xi at R, and R at xi.
struct Turns {
  const Likelihood& likelihood;
  const Attempt& attempt;

  bool noise_given() const { return likelihood.problem().noise().size() > 0; }

  /// Of the first step to the minimum at an R: what the next R moves anyhow is not worth a pass.
  double share() const { return noise_given() ? 0.0 : 0.01; }

  StageTwo find_minimum(StageTwo at) const {
    if (attempt.near) {
      if (auto there = likelihood.refine_downhill(at)) return std::move(*there);
    }
    return descend(std::move(at), share());
  }

  StageTwo follow_minimum(StageTwo at) const {
    at = likelihood.refine(std::move(at), share());
    return at.refined ? at : descend(std::move(at), share());
  }

  /// At an R that has settled.
  StageTwo find_last_digits(StageTwo at) const {
    at = likelihood.refine(std::move(at));
    if (!at.refined) at = descend(std::move(at), 0.0);
    at.noise = noise_at(at);
    return at;
  }

  StageTwo descend(StageTwo at, double share) const {
    at = likelihood.refine(likelihood.descend(std::move(at), attempt.first_radius), share);
    if (at.refined || at.method != SecondStage::joint) return at;
    return likelihood.refine(likelihood.slide(std::move(at)), share);
  }

  Eigen::VectorXd noise_at(const StageTwo& at) const { return likelihood.noise_at(at); }
  void take_noise(StageTwo& at, Eigen::VectorXd noise) const { at.noise = std::move(noise); }
};

/// xi at R, R at xi, and so on; then xi to the last digit.
StageTwo alternate_to_last_digits(Turns& turns, StageTwo at, const FitOptions& options) {
  at = alternate(turns, std::move(at), options);
  if (turns.noise_given() || !at.converged()) return at;
  return turns.find_last_digits(std::move(at));
}

/// Step 5 in one way.
StageTwo fit_once(const Likelihood& likelihood, const StageOne& start, const Attempt& attempt) {
  const FitOptions& options = likelihood.problem().options();
  Turns turns{likelihood, attempt};
  // 1. Begin where stage one ended, with the noise of its residuals (Eq. 24).
  StageTwo at = likelihood.begin(start, attempt.method);
  // 2. What the record leaves open there is held by a loose prior.
  if (attempt.hold) at = likelihood.hold_open(std::move(at), attempt.near);
  // 3. xi at R (Eqs. 6, 20, 27), R at xi (Eq. 25), and so on until R settles (Eq. 26).
  at = alternate_to_last_digits(turns, std::move(at), options);
  // 4. A poor start may have seen less than the solution does: what holds nothing open has to go.
  if (at.hold && !likelihood.leaves_open(at)) {
    at.hold.reset();
    at = alternate_to_last_digits(turns, std::move(at), options);
  }
  at.cost = likelihood.cost(at);
  std::ranges::move(explain(at, options), std::back_inserter(at.sentences));
  return at;
}

Ending ending_of(const Likelihood& likelihood, const StageTwo& end) {
  return {end.converged(), likelihood.leaves_open(end), end.hold.has_value(), end.cost};
}

constexpr auto fell_back_from_failure = "projected fell back to joint, because it did not converge";
constexpr auto fell_back_from_open =
    "projected fell back to joint, because the record leaves something open where it ended";

}  // namespace

StageTwo run_stage_two(const Problem& problem, const model::Measurements& measurements,
                       const StageOne& start, base::ThreadPool& pool) {
  return run_stage_two(problem, measurements, start, list_attempts(problem.options(), start), pool);
}

StageTwo run_stage_two(const Problem& problem, const model::Measurements& measurements,
                       const StageOne& start, const std::vector<Attempt>& attempts,
                       base::ThreadPool& pool) {
  const model::Sweep sweep(problem.model(), measurements, pool);
  const Likelihood likelihood(problem, sweep);
  const bool start_given = !problem.options().start.empty();
  StageTwo best = fit_once(likelihood, start, attempts.front());
  const Ending first = ending_of(likelihood, best);
  Ending best_ending = first;
  int iterations = best.iterations;
  for (std::size_t i = 1; i < attempts.size() && !is_enough(best_ending, start_given); ++i) {
    if (attempts[i].hold && best_ending.held) break;  // that was joint already
    StageTwo next = fit_once(likelihood, start, attempts[i]);
    const Ending ending = ending_of(likelihood, next);
    iterations += next.iterations;
    const bool settled = agree(ending, best_ending);
    if (is_better(ending, best_ending)) {
      best = std::move(next);
      best_ending = ending;
      if (attempts.front().method == SecondStage::projected && best.method == SecondStage::joint) {
        best.sentences.insert(best.sentences.begin(),
                              first.converged ? fell_back_from_open : fell_back_from_failure);
      }
    }
    if (settled) break;
  }
  best.iterations = iterations;
  best.passes = sweep.passes();
  return best;
}

std::vector<Attempt> list_attempts(const FitOptions& options, const StageOne& start) {
  const SecondStage asked = possible(options, options.second_stage);
  const bool automatic = asked == SecondStage::automatic;
  const bool separable = start.xi1.size() > 0;
  if (options.start.empty()) {
    if (!automatic) return {{asked}};
    if (!start.unique_minimum) return {{SecondStage::joint}};
    return {{SecondStage::projected}, {SecondStage::joint}};
  }
  const SecondStage method = !automatic  ? asked
                             : separable ? SecondStage::projected
                                         : SecondStage::joint;
  return {{method, customary, false},
          {automatic ? SecondStage::joint : method, gauss_newton, true},
          {method, short_steps, false},
          {method, within_the_basin, false}};
}

Attempt from_neighbour(const FitOptions& options, SecondStage method, bool hold) {
  return {possible(options, method), customary, hold, true};
}

Attempt within_basin(const FitOptions& options, SecondStage method) {
  return {possible(options, method), within_the_basin, false};
}

bool is_enough(const Ending& ending, bool start_given) {
  return ending.converged && !(start_given && ending.open);
}

bool is_better(const Ending& next, const Ending& best) {
  const auto merits = [](const Ending& ending) {
    return std::tuple(ending.converged, !ending.open, ending.held);
  };
  if (merits(next) != merits(best)) return merits(next) > merits(best);
  return next.cost < best.cost;
}

bool agree(const Ending& one, const Ending& other) {
  constexpr double one_standard_error = 0.5;  // of J
  return one.converged && other.converged && std::abs(one.cost - other.cost) <= one_standard_error;
}

}  // namespace sepcal::estimation
