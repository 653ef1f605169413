// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/rivals/haupt_kasdin.hpp"

#include "base/thread_pool.hpp"
#include "estimation/alternation.hpp"
#include "estimation/covariance.hpp"
#include "estimation/problem.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "rivals/noise_of.hpp"
#include "rivals/second_step.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/error.hpp"

namespace sepcal::rivals {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The first step with a square root of its information.
struct Solved {
  FirstStep step;
  MatrixXd root;  // S, p x p
};

/// Step one: y by linear least squares, R with it where it is not given (Eqs. 24-26).
Solved solve_first_step(const estimation::Problem& problem, const model::Sweep& sweep) {
  constexpr int most_turns = 100;
  constexpr double settled = 1e-10;
  const int p = sweep.tables().n_1();
  const Index n_z = sweep.tables().n_z();
  const std::vector<TriangularFactor> factors = sweep.linear_factors(VectorXd(0));
  const bool given = problem.noise().size() > 0;
  VectorXd sigma = given ? problem.noise() : VectorXd::Ones(n_z);
  Solved solved;
  for (int turn = 0; turn < most_turns; ++turn) {
    const TriangularFactor whitened = combine(factors, sigma.cwiseInverse());
    if (!whitened.all_finite()) throw Error("the first step's rows are not finite");
    const MatrixXd& T = whitened.matrix();
    solved.root = T.topLeftCorner(p, p);
    const TriangularSolution solution = solve_triangular(solved.root, T.col(p).head(p));
    solved.step.states = solution.x;
    solved.step.rank = solution.rank;
    solved.step.condition = whitened.condition(p);
    if (given) break;
    const VectorXd found =
        noise_of(sweep.squared_residuals(solution.x, VectorXd(0)), sweep.measurements());
    if (!found.allFinite()) throw Error("the first step's residuals overflow; use another unit");
    const double change = estimation::change_of_variance(sigma, found);
    solved.root *= n_z == 1 ? sigma[0] / found[0] : 1.0;
    sigma = found;
    if (change < settled || n_z == 1) break;
  }
  solved.step.information = solved.root.transpose() * solved.root;
  for (const Variable& state : sweep.tables().linear) solved.step.names.push_back(state.name);
  for (Index j = 0; j < n_z; ++j) {
    const auto at = static_cast<std::size_t>(j);
    solved.step.noise.push_back({sweep.tables().outputs[at].name, sigma[j]});
  }
  return solved;
}

/// (J'J)^-1; NaN throughout where J leaves a direction open.
MatrixXd covariance_of(MatrixXd J) {
  TriangularFactor factor(static_cast<int>(J.cols()));
  factor.absorb(J);
  return estimation::inverse_of_square(factor.matrix());
}

}  // namespace

HauptKasdinFit fit_haupt_kasdin(const BlockModel& first_step, const Record& record,
                                const ChangeOfVariables& change,
                                const std::map<std::string, double>& start,
                                const HauptKasdinOptions& options) {
  if (first_step.tables().n_2() > 0) {
    throw Error("the first step is linear: '" + first_step.tables().nonlinear.front().name +
                "' must not be among its parameters");
  }
  FitOptions asked;
  asked.noise = options.noise;
  const estimation::Problem problem(first_step, asked);
  base::ThreadPool pool(options.threads);
  const model::Measurements measurements(
      first_step,
      model::with_constant_outputs(first_step.tables(), record.select(options.segments)));
  if (measurements.rows() == 0) throw Error("the record has no rows");
  const model::Sweep sweep(first_step, measurements, pool);
  Solved first = solve_first_step(problem, sweep);

  const SecondStepModel second(change, first.root);
  SingleStageOptions single;
  single.bounds = options.bounds;
  single.solver = options.solver;
  single.evaluations = options.evaluations;
  single.threads = 1;
  for (const Variable& output : second.tables().outputs) single.noise[output.name] = 1.0;
  const SingleStageFit end =
      fit_single_stage(second, second.measure(first.step.states), start, single);

  HauptKasdinFit fit;
  fit.first = std::move(first.step);
  fit.converged = end.converged;
  fit.names = end.names;
  fit.estimates = end.estimates;
  fit.covariance = covariance_of(second.slopes(end.estimates));
  fit.standard_errors = fit.covariance.diagonal().cwiseSqrt();
  fit.cost = 2.0 * end.cost;
  fit.evaluations = end.evaluations;
  return fit;
}

}  // namespace sepcal::rivals
