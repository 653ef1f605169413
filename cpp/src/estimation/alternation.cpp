// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/alternation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimation/objective.hpp"
#include "estimation/plausibility.hpp"
#include "sepcal/identifiability.hpp"

namespace sepcal::estimation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Alternation::Alternation(const Problem& problem, const model::Sweep& sweep, double first_radius,
                         StageTwo& result)
    : problem_(problem),
      sweep_(sweep),
      box_(problem.box()),
      scale_(VectorXd::Ones(box_.lower.size())),
      descent_{.iterations = problem.options().iterations, .first_radius = first_radius},
      priors_(problem.knowledge()),
      result_(result) {
  const FitOptions& options = problem.options();
  if (options.loss != Loss::squares) loss_.emplace(options.loss, options.loss_width);
}

void Alternation::begin_noise() {
  result_.noise = raise_to_floor(loss_ ? scales(*loss_) : result_.noise);
}

void Alternation::look_around(const Attempt& attempt) {
  const auto factors = sweep_.tangent_factors(xi1(), xi2());
  const TriangularFactor factor = whiten(factors);
  if (!factor.all_finite()) return;
  const Index n = result_.x.size();
  const std::vector<Variable>& parameters = problem_.parameters();
  scale_ = plausible_scale(parameters, factors, sweep_.measurements());
  if (!attempt.hold || !leaves_open(factor.matrix().topLeftCorner(n, n), scale_)) return;
  const Prior loose = loose_prior(parameters, scale_);
  priors_.push_back(loose);
  result_.method = SecondStage::joint;
  if (attempt.near) return;
  result_.x.head(sweep_.tables().n_1()) = box_.clip(loose.mean).head(sweep_.tables().n_1());
}

void Alternation::descend() {
  if (result_.method == SecondStage::projected && descend_projected()) return;
  result_.method = SecondStage::joint;
  JointObjective objective(sweep_, weights(), priors_, loss_);
  const Descent descent = minimise(objective, result_.x, box_, descent_);
  result_.iterations += descent.iterations;
  result_.x = descent.x;
}

bool Alternation::refine() {
  JointObjective objective(sweep_, weights(), priors_, loss_);
  const Refinement refinement = estimation::refine(objective, result_.x, box_, scale_);
  take(refinement, objective);
  return refinement.converged;
}

bool Alternation::refine_downhill() {
  JointObjective objective(sweep_, weights(), priors_, loss_);
  const Refinement refinement = estimation::refine_downhill(objective, result_.x, box_, scale_);
  if (refinement.converged) take(refinement, objective);
  return refinement.converged;
}

void Alternation::take(const Refinement& refinement, const JointObjective& objective) {
  result_.x = refinement.x;
  result_.at_bound = refinement.at_bound;
  result_.factors = objective.factors();
  scale_ = plausible_scale(problem_.parameters(), result_.factors, sweep_.measurements());
  result_.iterations += refinement.iterations;
  // R moves the minimum, so that a bound of a linear parameter may come in the way only now.
  if (result_.method == SecondStage::projected) {
    for (Index k = 0; k < sweep_.tables().n_1(); ++k) {
      if (!result_.at_bound[static_cast<std::size_t>(k)]) continue;
      fall_back_to_joint(k);
      break;
    }
  }
}

double Alternation::update_noise() {
  const VectorXd next = raise_to_floor(
      loss_ ? scales(*loss_) : VectorXd((squares(result_.factors) / rows()).cwiseSqrt()));
  const VectorXd ratios = next.cwiseQuotient(result_.noise);
  result_.noise = next;
  return (ratios.array().square() - 1.0).abs().maxCoeff();
}

bool Alternation::ends_open() const {
  const TriangularFactor factor = whiten(result_.factors);
  const Index n = result_.x.size();
  return !factor.all_finite() || leaves_open(factor.matrix().topLeftCorner(n, n), scale_);
}

bool Alternation::holds() const { return priors_.size() > problem_.knowledge().size(); }

bool Alternation::release_what_is_determined() {
  if (!holds() || ends_open()) return false;
  priors_.pop_back();
  return true;
}

TriangularFactor Alternation::whiten(const std::vector<TriangularFactor>& factors) const {
  TriangularFactor factor = combine(factors, weights());
  for (const Prior& known : problem_.knowledge()) known.join(factor, result_.x);
  return factor;
}

VectorXd Alternation::scales(const model::RobustLoss& loss) const {
  const MatrixXd residuals = sweep_.residuals(xi1(), xi2());
  VectorXd noise(residuals.cols());
  for (Index j = 0; j < noise.size(); ++j) noise[j] = loss.scale(residuals.col(j));
  return noise;
}

VectorXd Alternation::raise_to_floor(VectorXd noise) const {
  for (Index j = 0; j < noise.size(); ++j) {
    const double square = sweep_.measurements().output_square(static_cast<int>(j)) / rows();
    const double smallest = std::sqrt(std::numeric_limits<double>::min());
    noise[j] = std::max({noise[j], 1e-12 * std::sqrt(square), smallest});
  }
  return noise;
}

bool Alternation::descend_projected() {
  ProjectedObjective objective(sweep_, weights(), priors_, problem_.options().jacobian);
  const Descent descent = minimise(objective, xi2(), problem_.nonlinear_box(), descent_);
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

void Alternation::fall_back_to_joint(Index bounded) {
  result_.method = SecondStage::joint;
  result_.message += "projected fell back to joint, because the bound of " +
                     problem_.parameters()[static_cast<std::size_t>(bounded)].name + " is active; ";
}

}  // namespace sepcal::estimation
