// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimation/objective.hpp"
#include "estimation/plausibility.hpp"
#include "estimation/sqp.hpp"
#include "sepcal/detail/identifiability.hpp"

namespace sepcal::estimation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Likelihood::Likelihood(const Problem& problem, const model::Sweep& sweep)
    : problem_(problem), sweep_(sweep), box_(problem.box()) {
  const FitOptions& options = problem.options();
  if (options.loss != Loss::squares) loss_.emplace(options.loss, options.loss_width);
}

StageTwo Likelihood::begin(const StageOne& start, SecondStage method) const {
  StageTwo at;
  at.method = method;
  at.x.resize(n_1() + n_2());
  at.x << start.xi1, start.xi2;
  at.x = box_.clip(at.x);
  if (problem_.noise().size() > 0) {
    at.noise = problem_.noise();
  } else {
    at.noise = raise_to_floor(loss_ ? scales(at, *loss_) : start.noise);
  }
  at.factors = sweep_.tangent_factors(at.x.head(n_1()), at.x.tail(n_2()));
  at.scale = whiten(at).all_finite()
                 ? plausible_scale(problem_.parameters(), at.factors, sweep_.measurements())
                 : VectorXd::Ones(at.x.size());
  return at;
}

StageTwo Likelihood::hold_open(StageTwo at, bool near) const {
  const TriangularFactor factor = whiten(at);
  const Index n = at.x.size();
  if (!factor.all_finite()) return at;
  if (!sepcal::leaves_open(factor.matrix().topLeftCorner(n, n), at.scale)) return at;
  at.hold = loose_prior(problem_.parameters(), at.scale);
  at.method = SecondStage::joint;
  if (!near) at.x.head(n_1()) = box_.clip(at.hold->mean).head(n_1());
  return at;
}

StageTwo Likelihood::descend(StageTwo at, double first_radius) const {
  if (at.method == SecondStage::projected) {
    ProjectedObjective objective(sweep_, at.noise.cwiseInverse(), priors(at),
                                 problem_.options().jacobian);
    const Descent end =
        minimise(objective, at.x.tail(n_2()), problem_.nonlinear_box(), descent(first_radius));
    at.iterations += end.iterations;
    VectorXd x(at.x.size());
    x << objective.linear_estimate(end.x), end.x;
    at.x = box_.clip(x);
    for (Index k = 0; k < x.size() && at.method == SecondStage::projected; ++k) {
      if (at.x[k] != x[k]) at = fall_back_to_joint(std::move(at), k);
    }
    if (at.method == SecondStage::projected) return at;
  }
  JointObjective objective = joint_objective(at);
  const Descent end = minimise(objective, at.x, box_, descent(first_radius));
  at.iterations += end.iterations;
  at.x = end.x;
  return at;
}

StageTwo Likelihood::slide(StageTwo at) const {
  constexpr int evaluations = 2;  // for each of Levenberg and Marquardt's iterations
  JointObjective objective = joint_objective(at);
  const double before = objective.square(at.x);
  const Descent end =
      descend_by_sqp(objective, at.x, box_, at.scale,
                     {.rows = rows(), .evaluations = evaluations * problem_.options().iterations});
  at.iterations += end.iterations;
  if (end.square < before) at.x = end.x;
  return at;
}

StageTwo Likelihood::refine(StageTwo at, double share) const {
  JointObjective objective = joint_objective(at);
  const Refinement refinement = estimation::refine(objective, at.x, box_, at.scale, share);
  return take(std::move(at), refinement, objective);
}

std::optional<StageTwo> Likelihood::refine_downhill(const StageTwo& at) const {
  JointObjective objective = joint_objective(at);
  const Refinement refinement = estimation::refine_downhill(objective, at.x, box_, at.scale);
  if (!refinement.converged) return {};
  return take(at, refinement, objective);
}

VectorXd Likelihood::noise_at(const StageTwo& at) const {
  return raise_to_floor(loss_ ? scales(at, *loss_)
                              : VectorXd((squares(at.factors) / rows()).cwiseSqrt()));
}

bool Likelihood::leaves_open(const StageTwo& at) const {
  const TriangularFactor factor = whiten(at);
  const Index n = at.x.size();
  return !factor.all_finite() || sepcal::leaves_open(factor.matrix().topLeftCorner(n, n), at.scale);
}

double Likelihood::cost(const StageTwo& at) const {
  const VectorXd sums = squares(at.factors).cwiseQuotient(at.noise.cwiseAbs2());
  double J = 0.5 * sums.sum() + rows() * at.noise.array().log().sum();
  for (const Prior& prior : problem_.prior()) J += 0.5 * prior.square(at.x);
  return J;
}

DescentOptions Likelihood::descent(double first_radius) const {
  return {.iterations = problem_.options().iterations, .first_radius = first_radius};
}

std::vector<Prior> Likelihood::priors(const StageTwo& at) const {
  std::vector<Prior> all = problem_.prior();
  if (at.hold) all.push_back(*at.hold);
  return all;
}

TriangularFactor Likelihood::whiten(const StageTwo& at) const {
  TriangularFactor factor = combine(at.factors, at.noise.cwiseInverse());
  for (const Prior& prior : problem_.prior()) prior.join(factor, at.x);
  return factor;
}

JointObjective Likelihood::joint_objective(const StageTwo& at) const {
  return {sweep_, at.noise.cwiseInverse(), priors(at), loss_};
}

StageTwo Likelihood::take(StageTwo at, const Refinement& refinement,
                          const JointObjective& objective) const {
  at.x = refinement.x;
  at.at_bound = refinement.at_bound;
  at.refined = refinement.converged;
  at.factors = objective.factors();
  at.scale = plausible_scale(problem_.parameters(), at.factors, sweep_.measurements());
  at.iterations += refinement.iterations;
  // R moves the minimum, so that a bound of a linear parameter may come in the way only now.
  for (Index k = 0; k < n_1() && at.method == SecondStage::projected; ++k) {
    if (at.at_bound[static_cast<std::size_t>(k)]) at = fall_back_to_joint(std::move(at), k);
  }
  return at;
}

StageTwo Likelihood::fall_back_to_joint(StageTwo at, Index bounded) const {
  at.method = SecondStage::joint;
  at.sentences.push_back("projected fell back to joint, because the bound of " +
                         problem_.parameters()[static_cast<std::size_t>(bounded)].name +
                         " is active");
  return at;
}

VectorXd Likelihood::scales(const StageTwo& at, const model::RobustLoss& loss) const {
  const MatrixXd residuals = sweep_.residuals(at.x.head(n_1()), at.x.tail(n_2()));
  VectorXd noise(residuals.cols());
  for (Index j = 0; j < noise.size(); ++j) noise[j] = loss.scale(residuals.col(j));
  return noise;
}

VectorXd Likelihood::raise_to_floor(VectorXd noise) const {
  for (Index j = 0; j < noise.size(); ++j) {
    const double square = sweep_.measurements().output_square(static_cast<int>(j)) / rows();
    const double smallest = std::sqrt(std::numeric_limits<double>::min());
    noise[j] = std::max({noise[j], 1e-12 * std::sqrt(square), smallest});
  }
  return noise;
}

VectorXd squares(const std::vector<TriangularFactor>& factors) {
  VectorXd sums(static_cast<Index>(factors.size()));
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const MatrixXd& T = factors[j].matrix();
    sums[static_cast<Index>(j)] = T.col(T.cols() - 1).squaredNorm();
  }
  return sums;
}

}  // namespace sepcal::estimation
