// SPDX-License-Identifier: BSD-3-Clause
// The paper's bound of the cost from one xi2 (Eqs. 7 to 13), and the one that holds.
#include <algorithm>
#include <cmath>

#include "base/name_list.hpp"
#include "certificate/box_bound.hpp"
#include "certificate/limits.hpp"
#include "sepcal/certificate.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace certificate;  // this room's own

using Eigen::Index;
using Eigen::VectorXd;

namespace {

VectorXd sigma_of(const Tables& tables, const std::map<std::string, double>& noise) {
  VectorXd sigma = VectorXd::Ones(tables.n_z());
  for (const auto& [name, value] : noise) {
    const auto output = std::ranges::find(tables.outputs, name, &Variable::name);
    if (output == tables.outputs.end()) {
      throw Error("noise: there is no output '" + name +
                  "'; the model has: " + base::list_names(tables.outputs));
    }
    if (!(value > 0.0)) throw Error("noise of '" + name + "' must be above zero");
    sigma[output - tables.outputs.begin()] = value;
  }
  return sigma;
}

/// How far the rows of a sample may be from those at xi2p, in every way that the two bounds ask.
struct Distance {
  double of_a = 0.0;  // Lipschitz constants, the greatest of all samples
  double of_b = 0.0;
  Enclosure joint = Enclosure(0.0);  // sum of squares of dA xi1 + db, weighted
};

/// `apart` (n_2): how far xi2 is from xi2p; `linear` (n_1): of |xi1|.
Distance measure_distance(const EnclosedProblem& problem, const EnclosedRows& at,
                          const EnclosedRows& over, const VectorXd& apart, const VectorXd& linear) {
  const Index n_1 = problem.n_1();
  Distance distance;
  for (Index i = 0; i < problem.rows(); ++i) {
    Enclosure slopes_of_a(0.0);
    Enclosure slopes_of_b(0.0);
    Enclosure joint(0.0);
    for (Index l = 0; l <= n_1; ++l) {
      Enclosure by_slopes(0.0);
      for (Index j = 0; j < problem.n_2(); ++j) {
        const Enclosure slope(over.at(i, l)[1 + j].magnitude());
        by_slopes += slope * apart[j];
        (l < n_1 ? slopes_of_a : slopes_of_b) += square(slope * problem.weight(i));
      }
      const double by_values = (*over.at(i, l) - *at.at(i, l)).magnitude();
      const Enclosure moved(std::min(by_values, by_slopes.upper()));
      joint += l < n_1 ? moved * linear[l] : moved;
    }
    distance.joint += square(joint * problem.weight(i));
    distance.of_a = std::max(distance.of_a, sqrt(slopes_of_a).upper());
    distance.of_b = std::max(distance.of_b, sqrt(slopes_of_b).upper());
  }
  return distance;
}

}  // namespace

CostBound bound_cost(const BlockModel& model, const Record& record, const VectorXd& xi2p,
                     const CostBoundOptions& options) {
  const Tables& tables = model.tables();
  const EnclosedProblem problem(model, record, sigma_of(tables, options.noise));
  const Limits limits = limits_of(tables, options.bounds);
  if (xi2p.size() != tables.n_2())
    throw Error("xi2p must have a value for each of " + base::list_names(tables.nonlinear));
  VectorXd apart(tables.n_2());
  for (Index j = 0; j < apart.size(); ++j) {
    const Enclosure& range = limits.nonlinear[static_cast<std::size_t>(j)];
    if (!range.contains(xi2p[j])) {
      throw Error("xi2p: '" + tables.nonlinear[static_cast<std::size_t>(j)].name +
                  "' is outside of its bounds");
    }
    apart[j] = (range - Enclosure(xi2p[j])).magnitude();
  }
  const BoxBound guess = bound_over(problem, points(xi2p), limits.linear, infinity);
  CostBound bound;
  bound.cost = problem.cost(guess.xi1, xi2p).upper();
  const double least = bound_over(problem, points(xi2p), limits.linear, bound.cost).lower;
  const BoxBound whole = bound_over(problem, limits.nonlinear, limits.linear, bound.cost);
  VectorXd linear(tables.n_1());
  for (Index l = 0; l < linear.size(); ++l) {
    linear[l] = std::min((Enclosure(std::abs(whole.xi1[l])) + Enclosure(whole.reach[l])).upper(),
                         limits.linear[static_cast<std::size_t>(l)].magnitude());
  }
  const Distance distance = measure_distance(problem, problem.over(points(xi2p)),
                                             problem.over(limits.nonlinear), apart, linear);
  const auto N = static_cast<double>(record.rows());
  bound.l_1 = linear.norm();
  bound.l_2 = apart.norm();
  bound.l_a = distance.of_a;
  bound.l_b = distance.of_b;
  bound.paper_error = 0.5 * N * std::pow(bound.l_2, 2) *
                      (std::pow(bound.l_a * bound.l_1, 2) + std::pow(bound.l_b, 2));
  bound.paper_lower = bound.cost - bound.paper_error;
  bound.joint_error = (distance.joint * 0.5).upper();
  const Enclosure root = sqrt(Enclosure(least)) - sqrt(Enclosure(bound.joint_error));
  bound.lower = root.lower() > 0.0 ? square(Enclosure(root.lower())).lower() : 0.0;
  return bound;
}

}  // namespace sepcal
