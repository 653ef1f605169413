// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/stage_one.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "basins.hpp"
#include "objective.hpp"
#include "refine.hpp"
#include "sampling.hpp"
#include "sepcal/error.hpp"
#include "sepcal/identifiability.hpp"
#include "stages.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Lengths by which xi2 is measured: half the width of the bounds, or two standard deviations of an
/// unbounded parameter's prior.
VectorXd half_widths(const Problem& problem) {
  const std::vector<Variable> parameters = problem.nonlinear();
  VectorXd widths(static_cast<Index>(parameters.size()));
  for (Index k = 0; k < widths.size(); ++k) {
    const Variable& parameter = parameters[static_cast<std::size_t>(k)];
    widths[k] = 0.5 * (parameter.upper - parameter.lower);
    const auto prior = problem.options().priors.find(parameter.name);
    if (prior != problem.options().priors.end()) {
      widths[k] = std::min(widths[k], 2.0 * prior->second.standard_deviation);
    }
    if (!std::isfinite(widths[k])) widths[k] = 1.0;
  }
  return widths;
}

/// The smallest rise of the sum of squares that a record can tell from none: one standard error.
double noticeable_rise(double square, double measurements, double parameters) {
  return square / std::max(1.0, measurements - parameters);
}

/// Whether no point between a and b lies noticeably higher than both.
bool joined(Objective& objective, const Descent& a, const Descent& b, const VectorXd& widths,
            double rise) {
  constexpr double same_point = 1e-6;  // of the widths: not worth a pass over the record
  if ((a.x - b.x).cwiseQuotient(widths).norm() < same_point) return true;
  // Denser towards the ends: a minimum at the edge of the box may lie behind a near, low rise.
  for (const double t : {0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.95, 0.98}) {
    const double between = objective.square(a.x + t * (b.x - a.x));
    if (!(between <= std::max(a.square, b.square) + rise)) return false;
  }
  return true;
}

std::vector<std::string> describe_flat_directions(Objective& objective, const VectorXd& xi2,
                                                  const VectorXd& widths, double rise,
                                                  const std::vector<Variable>& parameters) {
  VectorXd residual;
  MatrixXd jacobian;
  if (xi2.size() == 0 || !objective.linearise(xi2, residual, jacobian)) return {};
  const Eigen::JacobiSVD<MatrixXd> svd(jacobian * widths.asDiagonal(), Eigen::ComputeFullV);
  const auto& singular = svd.singularValues();
  const double epsilon = 1e-13 * singular[0];
  const auto flat = (singular.array() <= std::max(2.0 * std::sqrt(rise), epsilon)).count();
  const MatrixXd directions = sparsify(svd.matrixV().rightCols(flat));
  std::vector<std::string> names;
  for (const Variable& parameter : parameters) names.push_back(parameter.name);
  std::vector<std::string> texts;
  for (Index i = 0; i < flat; ++i) {
    VectorXd direction = directions.col(i);
    for (double& share : direction) share = std::abs(share) > 0.1 ? share : 0.0;
    texts.push_back(combination_text(widths.cwiseProduct(direction), names));
  }
  return texts;
}

/// Descends into the deepest basins and keeps what is distinct, lowest first.
std::vector<Descent> find_minima(Objective& objective, const Problem& problem,
                                 const StageOne& result, const VectorXd& widths,
                                 double measurements) {
  const DescentOptions within_the_basin{.iterations = 50, .first_radius = 0.1};
  const MatrixXd scaled = widths.cwiseInverse().asDiagonal() * result.samples;
  std::vector<Descent> minima;
  std::vector<Basin> basins =
      find_basins(scaled, result.trace_r.array().log().matrix());  // depth as a ratio
  basins.resize(std::min(basins.size(), static_cast<std::size_t>(problem.options().descents)));
  for (const Basin& basin : basins) {
    Descent descent = minimise(objective, result.samples.col(basin.lowest), problem.nonlinear_box(),
                               within_the_basin);
    if (!std::isfinite(descent.square)) continue;
    descent.x = refine(objective, descent.x, problem.nonlinear_box(), widths).x;
    descent.square = objective.square(descent.x);
    const auto n = static_cast<double>(problem.parameters().size());
    const auto same = std::ranges::find_if(minima, [&](const Descent& other) {
      const double lower = std::min(descent.square, other.square);
      return joined(objective, descent, other, widths, noticeable_rise(lower, measurements, n));
    });
    if (same == minima.end()) {
      minima.push_back(std::move(descent));
    } else if (descent.square < same->square) {
      *same = std::move(descent);
    }
  }
  std::ranges::stable_sort(minima, {}, &Descent::square);
  return minima;
}

/// The problem's own question with the unsampled parameters held.
FitOptions hold_unsampled(const Problem& problem) {
  FitOptions options = problem.options();
  options.fixed.clear();
  options.bounds.clear();
  std::map<std::string, double> held;
  std::map<std::string, Normal> priors;
  for (const Variable& parameter : problem.parameters()) {
    options.bounds[parameter.name] = {parameter.lower, parameter.upper};
    const auto value = options.unsampled.find(parameter.name);
    if (value != options.unsampled.end()) {
      options.fixed[parameter.name] = std::clamp(value->second, parameter.lower, parameter.upper);
    } else if (const auto prior = options.priors.find(parameter.name);
               prior != options.priors.end()) {
      priors.insert(*prior);
    }
  }
  options.priors = std::move(priors);
  options.unsampled.clear();
  return options;
}

/// Points (n_2 x S) with the held parameters among the sampled ones.
MatrixXd insert_held(const Problem& problem, const std::map<std::string, double>& held,
                     const MatrixXd& sampled) {
  const std::vector<Variable> nonlinear = problem.nonlinear();
  MatrixXd points(static_cast<Index>(nonlinear.size()), sampled.cols());
  Index next = 0;
  for (Index k = 0; k < points.rows(); ++k) {
    const auto value = held.find(nonlinear[static_cast<std::size_t>(k)].name);
    if (value == held.end()) {
      points.row(k) = sampled.row(next++);
    } else {
      points.row(k).setConstant(value->second);
    }
  }
  return points;
}

StageOne run_without_unsampled(const Problem& problem, const Record& record, ThreadPool& pool) {
  const FitOptions reduced = hold_unsampled(problem);
  StageOne result = run_stage_one(Problem(problem.model(), reduced), record, pool);
  const auto insert = [&](const auto& points) {
    return insert_held(problem, reduced.fixed, points);
  };
  if (result.samples.cols() > 0) result.samples = insert(result.samples);
  result.best = insert(result.best);
  result.xi2 = insert(result.xi2);
  for (LocalMinimum& minimum : result.minima) minimum.xi2 = insert(minimum.xi2);
  return result;
}

}  // namespace

StageOne run_stage_one(const Problem& problem, const Record& record, ThreadPool& pool) {
  const FitOptions& options = problem.options();
  const auto is_unsampled = [&](const Variable& parameter) {
    return options.unsampled.contains(parameter.name);
  };
  if (options.start.empty() && std::ranges::any_of(problem.nonlinear(), is_unsampled)) {
    return run_without_unsampled(problem, record, pool);
  }
  const Record selected = record.select(options.stage_one_segments);
  const Measurements measurements(problem.model(), selected);
  problem.check_measurements(measurements.rows());
  const Sweep sweep(problem.model(), measurements, pool);
  const auto rows = static_cast<double>(measurements.rows());
  const auto n_z = static_cast<Index>(problem.model().tables().n_z());
  const std::vector<Variable> nonlinear = problem.nonlinear();
  const bool sampled = options.samples > 0 && options.start.empty() && !nonlinear.empty();

  StageOne result;
  result.xi2 = nominal_point(nonlinear, options);
  ProjectedObjective objective(sweep, VectorXd::Ones(n_z));  // R = I
  if (sampled) {
    // Steps 2 and 3: xi1 and Tr[R] at every sample.
    result.samples = draw_samples(nonlinear, options);
    const auto factors = sweep.sample_factors(result.samples, [&](double fraction) {
      if (options.progress) options.progress("stage one", fraction);
    });
    result.trace_r.resize(options.samples);
    for (Index s = 0; s < result.trace_r.size(); ++s) {
      const TriangularFactor& factor = factors[static_cast<std::size_t>(s)];
      result.trace_r[s] = factor.all_finite() ? remaining_square(factor) / rows : infinity;
    }
    Index best = 0;
    result.best_trace_r = result.trace_r.minCoeff(&best);
    if (!std::isfinite(result.best_trace_r)) {
      throw Error("the model is not finite at any of the " + std::to_string(options.samples) +
                  " samples of its nonlinear parameters; check its inputs and the bounds");
    }
    result.best = result.samples.col(best);

    // Step 4: how many minima there are, and whether they are points.
    const VectorXd widths = half_widths(problem);
    const double count = rows * static_cast<double>(n_z);
    for (const Descent& minimum : find_minima(objective, problem, result, widths, count)) {
      result.minima.push_back({minimum.x, minimum.square / rows});
    }
    result.xi2 = result.minima.empty() ? result.best : result.minima.front().xi2;
    const double rise = noticeable_rise(objective.square(result.xi2), count,
                                        static_cast<double>(problem.parameters().size()));
    result.flat_directions =
        describe_flat_directions(objective, result.xi2, widths, rise, nonlinear);
    result.unique_minimum = result.minima.size() == 1 && result.flat_directions.empty();
  }
  if (!std::isfinite(objective.square(result.xi2))) {
    throw Error(
        "the model is not finite at some row of the record, whatever its linear parameters; "
        "check its inputs, the fixed parameters and the bounds");
  }
  result.xi1 = objective.linear_estimate(result.xi2);
  result.noise = (sweep.squared_residuals(result.xi1, result.xi2) / rows).cwiseSqrt();
  if (!sampled) {
    result.best = result.xi2;
    result.best_trace_r = result.noise.squaredNorm();
    // A linear problem has one minimum; where nothing was sampled nothing is known.
    result.unique_minimum = nonlinear.empty();
    if (nonlinear.empty()) result.minima.push_back({result.xi2, result.best_trace_r});
  }
  return result;
}

StageOne stage_one(const BlockModel& model, const Record& record, const FitOptions& options) {
  const Problem problem(model, options);
  ThreadPool pool(options.threads);
  return run_stage_one(problem, record, pool);
}

}  // namespace sepcal
