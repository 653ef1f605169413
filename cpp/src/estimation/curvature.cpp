// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/curvature.hpp"

#include <cmath>
#include <vector>

#include "base/name_list.hpp"
#include "base/sentences.hpp"
#include "estimation/objective.hpp"
#include "numerics/decompositions.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Whether squares of whitened readings are so large (little noise is left, or none) that their sum
/// doesn't show a standard error.
bool drowns_in_rounding(const model::Measurements& measurements, const VectorXd& noise) {
  double whole = 0.0;
  for (Index j = 0; j < noise.size(); ++j) {
    whole += measurements.output_square(static_cast<int>(j)) / (noise[j] * noise[j]);
  }
  return !(whole < 1e12);
}

/// Whether the sum of squares at x + step is within a factor of two of the parabola's.
bool follows_parabola(JointObjective& objective, const VectorXd& residual, const MatrixXd& jacobian,
                      const VectorXd& x, const VectorXd& step) {
  constexpr double tolerance = 2.0;
  const VectorXd change = jacobian * step;
  const double expected = change.squaredNorm() + 2.0 * change.dot(residual);
  const double rise = objective.square(x + step) - residual.squaredNorm();
  return rise < tolerance * expected && rise > expected / tolerance;
}

}  // namespace

std::string describe_curvature(const Problem& problem, const model::Sweep& sweep,
                               const StageTwo& two) {
  constexpr double standard_errors = 3.0;
  constexpr double share_to_be_named = 0.2;  // of the largest
  if (problem.options().loss != Loss::squares || two.x.size() == 0) return "";
  if (drowns_in_rounding(sweep.measurements(), two.noise)) return "";
  JointObjective objective(sweep, two.noise.cwiseInverse(), problem.prior());
  VectorXd residual;
  MatrixXd jacobian;
  if (!objective.linearise(two.x, residual, jacobian)) return "";
  const Eigen::JacobiSVD<MatrixXd> svd(jacobian * two.scale.asDiagonal(), Eigen::ComputeFullV);
  const Index last = two.x.size() - 1;
  const VectorXd shares = svd.matrixV().col(last);
  const VectorXd step =
      standard_errors / svd.singularValues()[last] * two.scale.cwiseProduct(shares);
  if (!step.allFinite()) return "";
  const numerics::Box box = problem.box();
  bool follows = true;
  for (const VectorXd& way : {step, VectorXd(-step)}) {
    const bool inside = box.clip(two.x + way) == two.x + way;
    follows = follows && (!inside || follows_parabola(objective, residual, jacobian, two.x, way));
  }
  if (follows) return "";
  std::vector<std::string> names;
  for (Index k = 0; k <= last; ++k) {
    if (std::abs(shares[k]) < share_to_be_named * shares.cwiseAbs().maxCoeff()) continue;
    names.push_back(problem.parameters()[static_cast<std::size_t>(k)].name);
  }
  return base::one_sentence("the standard errors of " + base::list_names(names) +
                            " don't hold: the cost is no parabola within three of them (profile "
                            "intervals don't take it for one)");
}

}  // namespace sepcal::estimation
