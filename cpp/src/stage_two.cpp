// SPDX-License-Identifier: BSD-3-Clause
// Stage two: the constrained maximum-likelihood fit (Sun & Gebre-Egziabher, Step 5, Eqs. 6, 20,
// 24-27). Ceres descends; Gauss-Newton steps then take the last digits that a comparison of costs
// can't see; R and the parameters alternate until Eq. 26 holds.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "objective.hpp"
#include "plausibility.hpp"
#include "refine.hpp"
#include "sepcal/identifiability.hpp"
#include "stages.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Sum of squared residuals by output, off the factors of [A D r].
VectorXd squares(const std::vector<TriangularFactor>& factors) {
  VectorXd sums(static_cast<Index>(factors.size()));
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const MatrixXd& T = factors[j].matrix();
    sums[static_cast<Index>(j)] = T.col(T.cols() - 1).squaredNorm();
  }
  return sums;
}

class Alternation {
 public:
  Alternation(const Problem& problem, const Sweep& sweep, StageTwo& result)
      : problem_(problem),
        sweep_(sweep),
        box_(problem.box()),
        scale_(VectorXd::Ones(box_.lower.size())),
        priors_(problem.knowledge()),
        result_(result) {
    const FitOptions& options = problem.options();
    if (options.loss != Loss::squares) loss_.emplace(options.loss, options.loss_width);
  }

  /// The noise of the residuals at x, each output's own, with its floor.
  VectorXd estimate_noise() const {
    const VectorXd estimate =
        loss_ ? scales() : VectorXd((squares(result_.factors) / rows()).cwiseSqrt());
    return with_floor(estimate);
  }

  VectorXd with_floor(const VectorXd& noise) const {
    VectorXd raised = noise;
    for (Index j = 0; j < noise.size(); ++j) raised[j] = std::max(noise[j], noise_floor(j));
    return raised;
  }

  /// By the loss's own scale, which outliers don't raise.
  VectorXd scales() const {
    const MatrixXd residuals = sweep_.residuals(xi1(), xi2());
    VectorXd noise(residuals.cols());
    for (Index j = 0; j < noise.size(); ++j) noise[j] = loss_->scale(residuals.col(j));
    return noise;
  }

  bool forgives() const { return loss_.has_value(); }

  /// Where the record leaves a combination of parameters open at the start, nothing in it would
  /// keep them from running away: a loose prior does, and the fit is joint.
  void hold_what_is_open() {
    const auto factors = sweep_.tangent_factors(xi1(), xi2());
    const TriangularFactor factor = whiten(factors);
    if (!factor.all_finite()) return;
    const Index n = result_.x.size();
    const std::vector<Variable>& parameters = problem_.parameters();
    scale_ = plausible_scale(parameters, factors, sweep_.measurements());
    if (!leaves_open(factor.matrix().topLeftCorner(n, n), scale_)) return;
    const Prior loose = loose_prior(parameters, scale_);
    priors_.push_back(loose);
    result_.method = SecondStage::joint;
    result_.x.head(sweep_.tables().n_1()) = box_.clip(loose.mean).head(sweep_.tables().n_1());
  }

  /// Drops the prior where the solution turns out to determine everything; whether it did.
  bool release_what_is_determined() {
    const auto known = problem_.knowledge().size();
    if (priors_.size() == known) return false;
    const TriangularFactor factor = whiten(result_.factors);
    const Index n = result_.x.size();
    if (!factor.all_finite() || leaves_open(factor.matrix().topLeftCorner(n, n), scale_)) {
      return false;
    }
    priors_.resize(known);
    return true;
  }

  /// Minimises J over the parameters at the present R, from result.x.
  void descend() {
    if (result_.method == SecondStage::projected && descend_projected()) return;
    result_.method = SecondStage::joint;
    JointObjective objective(sweep_, weights(), priors_, loss_);
    const Descent descent =
        minimise(objective, result_.x, box_, {.iterations = problem_.options().iterations});
    result_.iterations += descent.iterations;
    result_.x = descent.x;
  }

  /// Takes x to the last digit at the present R; false, with x as it was, where no minimum is near.
  bool refine() {
    JointObjective objective(sweep_, weights(), priors_, loss_);
    const Refinement refinement = sepcal::refine(objective, result_.x, box_, scale_);
    result_.x = refinement.x;
    result_.at_bound = refinement.at_bound;
    result_.factors = objective.factors();
    result_.iterations += refinement.iterations;
    // R moves the minimum, so that a bound of a linear parameter may come in the way only now.
    if (result_.method == SecondStage::projected) {
      for (Index k = 0; k < sweep_.tables().n_1(); ++k) {
        if (!result_.at_bound[static_cast<std::size_t>(k)]) continue;
        fall_back_to_joint(k);
        break;
      }
    }
    return refinement.converged;
  }

  /// R-hat of the present residuals with its floor; the largest relative change (Eq. 26).
  double update_noise() {
    const VectorXd next = estimate_noise();
    const VectorXd ratios = next.cwiseQuotient(result_.noise);
    result_.noise = next;
    return (ratios.array().square() - 1.0).abs().maxCoeff();
  }

 private:
  VectorXd xi1() const { return result_.x.head(sweep_.tables().n_1()); }
  VectorXd xi2() const { return result_.x.tail(sweep_.tables().n_2()); }
  VectorXd weights() const { return result_.noise.cwiseInverse(); }
  double rows() const { return static_cast<double>(sweep_.measurements().rows()); }

  /// One factor of all outputs, with what is known beforehand.
  TriangularFactor whiten(const std::vector<TriangularFactor>& factors) const {
    TriangularFactor factor = combine(factors, weights());
    for (const Prior& known : problem_.knowledge()) known.join(factor, result_.x);
    return factor;
  }

  /// Keeps a noise-free output from sending J to minus infinity.
  double noise_floor(Index j) const {
    const double square = sweep_.measurements().output_square(static_cast<int>(j)) / rows();
    return std::max(1e-12 * std::sqrt(square), std::sqrt(std::numeric_limits<double>::min()));
  }

  /// False where a linear parameter left its bounds, which the inner problem does not know.
  bool descend_projected() {
    ProjectedObjective objective(sweep_, weights(), priors_, problem_.options().jacobian);
    const Descent descent = minimise(objective, xi2(), problem_.nonlinear_box(),
                                     {.iterations = problem_.options().iterations});
    result_.iterations += descent.iterations;
    VectorXd x(result_.x.size());
    x << objective.linear_estimate(descent.x), descent.x;
    result_.x = box_.clip(x);
    if (result_.x == x) return true;
    for (Index k = 0; k < x.size(); ++k) {
      if (result_.x[k] == x[k]) continue;
      fall_back_to_joint(k);
      break;
    }
    return false;
  }

  /// The inner problem of a projected fit does not know the bounds of linear parameters.
  void fall_back_to_joint(Index bounded) {
    result_.method = SecondStage::joint;
    result_.message += "projected fell back to joint, because the bound of " +
                       problem_.parameters()[static_cast<std::size_t>(bounded)].name +
                       " is active; ";
  }

  const Problem& problem_;
  const Sweep& sweep_;
  Box box_;
  VectorXd scale_;             // plausible length of each parameter
  std::vector<Prior> priors_;  // what is known, and what holds open combinations for a while
  std::optional<RobustLoss> loss_;
  StageTwo& result_;
};

struct Outcome {
  bool refined = false;
  bool settled = false;
};

/// The parameters at R, R at the parameters, and so on until Eq. 26 holds.
Outcome alternate(Alternation& alternation, StageTwo& result, const FitOptions& options,
                  bool noise_given) {
  constexpr int most_failures = 3;  // then another R will not help
  alternation.descend();
  Outcome outcome{alternation.refine(), noise_given};
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

}  // namespace

StageTwo run_stage_two(const Problem& problem, const Measurements& measurements,
                       const StageOne& start, ThreadPool& pool) {
  const FitOptions& options = problem.options();
  const Sweep sweep(problem.model(), measurements, pool);
  const bool noise_given = problem.noise().size() > 0;

  StageTwo result;
  result.method = options.second_stage;
  if (result.method == SecondStage::automatic) {
    const bool begun_elsewhere = !options.start.empty() && start.xi1.size() > 0;
    result.method =
        start.unique_minimum || begun_elsewhere ? SecondStage::projected : SecondStage::joint;
  }
  result.x.resize(start.xi1.size() + start.xi2.size());
  result.x << start.xi1, start.xi2;
  result.x = problem.box().clip(result.x);
  result.noise = noise_given ? problem.noise() : start.noise;
  if (options.loss != Loss::squares) result.method = SecondStage::joint;

  Alternation alternation(problem, sweep, result);
  if (!noise_given) {
    result.noise =
        alternation.with_floor(alternation.forgives() ? alternation.scales() : start.noise);
  }
  alternation.hold_what_is_open();
  Outcome outcome = alternate(alternation, result, options, noise_given);
  // A poor start may have seen less than the solution does: what holds nothing open has to go.
  if (alternation.release_what_is_determined()) {
    outcome = alternate(alternation, result, options, noise_given);
  }
  result.converged = outcome.refined && outcome.settled;
  if (!outcome.refined) {
    result.message +=
        "the minimisation did not converge: no minimum was found near where it ended; "
        "look for a wrong unit or sign, or bounds that are too wide; ";
  } else if (!outcome.settled) {
    result.message +=
        "R did not settle within " + std::to_string(options.noise_iterations) + " iterations; ";
  }
  return result;
}

}  // namespace sepcal
