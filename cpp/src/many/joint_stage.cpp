// SPDX-License-Identifier: BSD-3-Clause
#include "many/joint_stage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "estimation/alternation.hpp"
#include "many/joint_start.hpp"
#include "many/minimise_many.hpp"
#include "sepcal/detail/identifiability.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// J of many flights, at the objective's point and noise, and the steps to its minimum.
class JointLikelihood {
 public:
  JointLikelihood(const JointProblem& joint, ManyObjective& objective)
      : joint_(joint), objective_(objective) {}

  /// The flights' own ends, with their pooled noise; what they leave open is held by loose priors.
  JointStage begin() {
    JointStage at;
    at.noise = joint_.noise_given() ? joint_.problem.noise() : pooled_noise(joint_.starts);
    for (Index j = 0; j < at.noise.size() && !joint_.noise_given(); ++j) {
      at.noise[j] = std::max(at.noise[j], joint_.noise_floor(j));
    }
    objective_.weigh(at.noise.cwiseInverse());
    for (const estimation::Prior& prior : joint_.prior()) objective_.set_prior(prior);
    at.x = find_joint_start(objective_, joint_.starts, joint_.box);
    scale_ = plausible_lengths(joint_, objective_);
    held_ = leaves_something_open();
    if (held_) objective_.hold(loose_priors());
    return at;
  }

  /// Drops the priors; whether the fit has to be repeated without them, as the solution turns out
  /// to determine everything.
  bool release() {
    if (!held_) return false;
    objective_.hold({});
    return !leaves_something_open();
  }

  bool noise_given() const { return joint_.noise_given(); }

  JointStage find_minimum(JointStage at) const { return refine(descend(std::move(at))); }

  JointStage follow_minimum(JointStage at) const {
    at = refine(std::move(at));
    return at.refined ? at : find_minimum(std::move(at));
  }

  /// Of the present residuals, with its floor.
  VectorXd noise_at(const JointStage& at) const {
    VectorXd sums = VectorXd::Zero(at.noise.size());
    for (Index i = 0; i < joint_.layout.flights; ++i) sums += objective_.squares(i);
    for (Index j = 0; j < sums.size(); ++j) {
      sums[j] = std::max(std::sqrt(sums[j] / joint_.rows), joint_.noise_floor(j));
    }
    return sums;
  }

  void take_noise(JointStage& at, VectorXd noise) const {
    at.noise = std::move(noise);
    objective_.weigh(at.noise.cwiseInverse());
  }

 private:
  JointStage descend(JointStage at) const {
    const estimation::Descent descent =
        minimise_many(objective_, at.x, joint_.box, joint_.problem.options().iterations);
    at.iterations += descent.iterations;
    at.x = descent.x;
    return at;
  }

  JointStage refine(JointStage at) const {
    const estimation::Refinement refinement = refine_many(objective_, at.x, joint_.box, scale_);
    at.x = refinement.x;
    at.at_bound = refinement.at_bound;
    at.iterations += refinement.iterations;
    at.refined = refinement.converged;
    return at;
  }

  bool leaves_something_open() const {
    if (!std::ranges::all_of(objective_.blocks(), &TriangularFactor::all_finite)) return false;
    const Eliminated all = eliminate_own(objective_);
    for (Index i = 0; i < joint_.layout.flights; ++i) {
      const MatrixXd K = beside_others(all.shares[static_cast<std::size_t>(i)], all.shared);
      if (leaves_open(K, joint_.layout.point(scale_, i))) return true;
    }
    return false;
  }

  /// Of the shared parameters it stands in the first flight's.
  std::vector<estimation::Prior> loose_priors() const {
    std::vector<estimation::Prior> priors;
    for (Index i = 0; i < joint_.layout.flights; ++i) {
      priors.push_back(estimation::loose_prior(variables(joint_.problem, joint_.parting),
                                               joint_.layout.point(scale_, i)));
      if (i > 0) priors.back().weight.tail(joint_.layout.shared).setZero();
    }
    return priors;
  }

  const JointProblem& joint_;
  ManyObjective& objective_;
  VectorXd scale_;
  bool held_ = false;
};

}  // namespace

std::vector<estimation::Prior> JointProblem::prior() const {
  std::vector<estimation::Prior> priors = problem.prior();
  const std::vector<Index> order = parting.order();
  for (estimation::Prior& prior : priors) prior = {prior.mean(order), prior.weight(order)};
  return priors;
}

Compared JointProblem::compared() const {
  Compared compared{.layout = layout, .measurements = {}, .chi_squared = noise_given()};
  for (const FlightStart& start : starts) {
    compared.measurements.push_back(static_cast<double>(start.rows) *
                                    static_cast<double>(output_squares.size()));
  }
  return compared;
}

double JointProblem::noise_floor(Index j) const {
  return std::max(1e-12 * std::sqrt(output_squares[j] / rows),
                  std::sqrt(std::numeric_limits<double>::min()));
}

Eliminated eliminate_own(const ManyObjective& objective) {
  std::vector<Share> shares;
  for (const TriangularFactor& block : objective.flight_blocks()) {
    shares.push_back(eliminate_own(block.matrix(), objective.layout().own));
  }
  const MatrixXd shared = shared_factor(shares, objective.shared_prior().matrix());
  return {std::move(shares), shared};
}

VectorXd plausible_lengths(const JointProblem& joint, const ManyObjective& objective) {
  const std::vector<Variable> parameters = variables(joint.problem, joint.parting);
  VectorXd lengths(joint.layout.size());
  std::vector<TriangularFactor> all;
  for (Index i = 0; i < joint.layout.flights; ++i) {
    const auto& factors = objective.factors()[static_cast<std::size_t>(i)];
    const double z_square = joint.starts[static_cast<std::size_t>(i)].output_squares.sum();
    joint.layout.own_of(lengths, i) =
        estimation::plausible_scale(parameters, factors, z_square).head(joint.layout.own);
    all.insert(all.end(), factors.begin(), factors.end());
  }
  lengths.tail(joint.layout.shared) =
      estimation::plausible_scale(parameters, all, joint.output_squares.sum())
          .tail(joint.layout.shared);
  return lengths;
}

JointStage run_joint_stage(const JointProblem& joint, ManyObjective& objective) {
  const FitOptions& options = joint.problem.options();
  JointLikelihood likelihood(joint, objective);
  JointStage end = estimation::alternate(likelihood, likelihood.begin(), options);
  if (likelihood.release()) end = estimation::alternate(likelihood, std::move(end), options);
  end.sentences = estimation::explain(end, options, " in one of the flights");
  objective.linearise(end.x);
  return end;
}

}  // namespace sepcal::many
