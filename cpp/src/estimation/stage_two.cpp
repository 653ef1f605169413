// SPDX-License-Identifier: BSD-3-Clause
// Stage two: the constrained maximum-likelihood fit (Sun & Gebre-Egziabher, Step 5, Eqs. 6, 20,
// 24-27). Ceres descends; Gauss-Newton steps then take the last digits that a comparison of costs
// can't see; R and the parameters alternate until Eq. 26 holds.
#include <string>
#include <utility>

#include "estimation/alternation.hpp"
#include "estimation/attempts.hpp"
#include "estimation/stages.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Outcome {
  bool refined = false;
  bool settled = false;
};

/// The parameters at R, R at the parameters, and so on until Eq. 26 holds. `near`: the parameters
/// are all but there.
Outcome alternate(Alternation& alternation, StageTwo& result, const FitOptions& options,
                  bool noise_given, bool near) {
  constexpr int most_failures = 3;  // then another R will not help
  Outcome outcome{near && alternation.refine_downhill(), noise_given};
  if (!outcome.refined) {
    alternation.descend();
    outcome.refined = alternation.refine();
  }
  int failures = outcome.refined ? 0 : 1;
  int updates = 0;
  while (!outcome.settled && failures < most_failures && updates < options.noise_iterations) {
    outcome.settled = alternation.update_noise() < options.noise_tolerance;
    ++updates;
    if (options.progress) {
      options.progress("stage two", static_cast<double>(updates) /
                                        static_cast<double>(options.noise_iterations));
    }
    if (outcome.settled) break;
    outcome.refined = alternation.refine();
    if (outcome.refined) continue;
    alternation.descend();
    outcome.refined = alternation.refine();
    if (!outcome.refined) ++failures;
  }
  if (!outcome.settled) alternation.update_noise();  // the noise of the parameters returned
  result.noise_iterations += updates;
  return outcome;
}

constexpr auto fell_back_from_failure =
    "projected fell back to joint, because it did not converge; ";
constexpr auto fell_back_from_open =
    "projected fell back to joint, because the record leaves something open where it ended; ";

/// Stage two in one way; fills `result`.
Ending try_once(const Problem& problem, const model::Sweep& sweep, const StageOne& start,
                const Attempt& attempt, StageTwo& result) {
  const bool noise_given = problem.noise().size() > 0;
  result.method = attempt.method;
  result.x.resize(start.xi1.size() + start.xi2.size());
  result.x << start.xi1, start.xi2;
  result.x = problem.box().clip(result.x);
  result.noise = noise_given ? problem.noise() : start.noise;

  Alternation alternation(problem, sweep, attempt.first_radius, result);
  if (!noise_given) alternation.begin_noise();
  alternation.look_around(attempt);
  Outcome outcome = alternate(alternation, result, problem.options(), noise_given, attempt.near);
  // A poor start may have seen less than the solution does: what holds nothing open has to go.
  if (alternation.release_what_is_determined()) {
    outcome = alternate(alternation, result, problem.options(), noise_given, attempt.near);
  }
  result.converged = outcome.refined && outcome.settled;
  result.held = alternation.holds();
  if (!outcome.refined) {
    result.message +=
        "the minimisation did not converge: no minimum was found near where it ended; "
        "look for a wrong unit or sign, or bounds that are too wide; ";
  } else if (!outcome.settled) {
    result.message += "R did not settle within " +
                      std::to_string(problem.options().noise_iterations) + " iterations; ";
  }
  const auto rows = static_cast<double>(sweep.measurements().rows());
  return {result.converged, alternation.ends_open(), alternation.holds(),
          find_cost(problem, result, rows)};
}

}  // namespace

VectorXd squares(const std::vector<TriangularFactor>& factors) {
  VectorXd sums(static_cast<Index>(factors.size()));
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const MatrixXd& T = factors[j].matrix();
    sums[static_cast<Index>(j)] = T.col(T.cols() - 1).squaredNorm();
  }
  return sums;
}

double find_cost(const Problem& problem, const StageTwo& two, double rows) {
  const VectorXd sums = squares(two.factors).cwiseQuotient(two.noise.cwiseAbs2());
  double J = 0.5 * sums.sum() + rows * two.noise.array().log().sum();
  for (const Prior& prior : problem.knowledge()) J += 0.5 * prior.square(two.x);
  return J;
}

StageTwo run_stage_two(const Problem& problem, const model::Measurements& measurements,
                       const StageOne& start, base::ThreadPool& pool) {
  return run_stage_two(problem, measurements, start, list_attempts(problem.options(), start), pool);
}

StageTwo run_stage_two(const Problem& problem, const model::Measurements& measurements,
                       const StageOne& start, const std::vector<Attempt>& attempts,
                       base::ThreadPool& pool) {
  const model::Sweep sweep(problem.model(), measurements, pool);
  const bool start_given = !problem.options().start.empty();
  StageTwo best;
  const Ending first = try_once(problem, sweep, start, attempts.front(), best);
  Ending best_ending = first;
  int iterations = best.iterations;
  for (std::size_t i = 1; i < attempts.size() && !is_enough(best_ending, start_given); ++i) {
    if (attempts[i].hold && best_ending.held) break;  // that was joint already
    StageTwo result;
    const Ending ending = try_once(problem, sweep, start, attempts[i], result);
    iterations += result.iterations;
    const bool settled = agree(ending, best_ending);
    if (is_better(ending, best_ending)) {
      best = std::move(result);
      best_ending = ending;
      if (attempts.front().method == SecondStage::projected && best.method == SecondStage::joint) {
        best.message.insert(0, first.converged ? fell_back_from_open : fell_back_from_failure);
      }
    }
    if (settled) break;
  }
  best.iterations = iterations;
  return best;
}

}  // namespace sepcal::estimation
