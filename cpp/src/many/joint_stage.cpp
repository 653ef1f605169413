// SPDX-License-Identifier: BSD-3-Clause
#include "many/joint_stage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "many/joint_start.hpp"
#include "many/minimise_many.hpp"
#include "sepcal/identifiability.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class JointAlternation {
 public:
  JointAlternation(const JointProblem& joint, ManyObjective& objective, JointStage& result)
      : joint_(joint), objective_(objective), result_(result) {}

  void begin() {
    result_.noise = joint_.noise_given() ? joint_.problem.noise() : pooled_noise(joint_.starts);
    for (Index j = 0; j < result_.noise.size() && !joint_.noise_given(); ++j) {
      result_.noise[j] = std::max(result_.noise[j], joint_.noise_floor(j));
    }
    objective_.weigh(result_.noise.cwiseInverse());
    for (const estimation::Prior& prior : joint_.knowledge()) objective_.know(prior);
    result_.x = find_joint_start(objective_, joint_.starts, joint_.box);
    scale_ = plausible_lengths(joint_, objective_);
    if (leaves_something_open()) objective_.hold(loose_priors());
  }

  /// Drops the priors; whether the fit has to be repeated without them, as the solution turns out
  /// to determine everything.
  bool release() {
    if (!held_) return false;
    objective_.hold({});
    return !leaves_something_open();
  }

  /// The parameters at R, R at the parameters, and so on until Eq. 26 holds.
  void alternate() {
    constexpr int most_failures = 3;  // then another R will not help
    const FitOptions& options = joint_.problem.options();
    descend();
    refined_ = refine();
    settled_ = joint_.noise_given();
    int failures = refined_ ? 0 : 1;
    int updates = 0;
    while (!settled_ && failures < most_failures && updates < options.noise_iterations) {
      settled_ = update_noise() < options.noise_tolerance;
      ++updates;
      if (options.progress) {
        options.progress("stage two", static_cast<double>(updates) / options.noise_iterations);
      }
      if (settled_) break;
      refined_ = refine();
      if (refined_) continue;
      descend();
      refined_ = refine();
      if (!refined_) ++failures;
    }
    if (!settled_) update_noise();
    result_.noise_iterations += updates;
  }

  void conclude() const {
    result_.converged = refined_ && settled_;
    if (!refined_) {
      result_.message =
          "the minimisation did not converge: no minimum was found near where it ended; look for a "
          "wrong unit or sign in one of the flights, or bounds that are too wide; ";
    } else if (!settled_) {
      result_.message = "R did not settle within " +
                        std::to_string(joint_.problem.options().noise_iterations) + " iterations; ";
    }
  }

 private:
  void descend() {
    const estimation::Descent descent =
        minimise_many(objective_, result_.x, joint_.box, joint_.problem.options().iterations);
    result_.iterations += descent.iterations;
    result_.x = descent.x;
  }

  bool refine() {
    const estimation::Refinement refinement =
        refine_many(objective_, result_.x, joint_.box, scale_);
    result_.x = refinement.x;
    result_.at_bound = refinement.at_bound;
    result_.iterations += refinement.iterations;
    return refinement.converged;
  }

  /// R-hat of the present residuals with its floor; the largest relative change (Eq. 26).
  double update_noise() {
    VectorXd sums = VectorXd::Zero(result_.noise.size());
    for (Index i = 0; i < joint_.layout.flights; ++i) sums += objective_.squares(i);
    double change = 0.0;
    for (Index j = 0; j < sums.size(); ++j) {
      const double next = std::max(std::sqrt(sums[j] / joint_.rows), joint_.noise_floor(j));
      const double ratio = next / result_.noise[j];
      change = std::max(change, std::abs(ratio * ratio - 1.0));
      result_.noise[j] = next;
    }
    objective_.weigh(result_.noise.cwiseInverse());
    return change;
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
  std::vector<estimation::Prior> loose_priors() {
    held_ = true;
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
  JointStage& result_;
  VectorXd scale_;
  bool held_ = false;
  bool refined_ = false;
  bool settled_ = false;
};

}  // namespace

std::vector<estimation::Prior> JointProblem::knowledge() const {
  std::vector<estimation::Prior> known = problem.knowledge();
  const std::vector<Index> order = parting.order();
  for (estimation::Prior& prior : known) prior = {prior.mean(order), prior.weight(order)};
  return known;
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
  const MatrixXd shared = shared_factor(shares, objective.shared_knowledge().matrix());
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
  JointStage result;
  JointAlternation alternation(joint, objective, result);
  alternation.begin();
  alternation.alternate();
  if (alternation.release()) alternation.alternate();
  alternation.conclude();
  objective.linearise(result.x);
  return result;
}

}  // namespace sepcal::many
