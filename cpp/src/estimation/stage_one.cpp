// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/stage_one.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "estimation/global_search.hpp"
#include "estimation/minima.hpp"
#include "estimation/objective.hpp"
#include "estimation/sampling.hpp"
#include "estimation/screens.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace estimation;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Hears the fraction of stage one that is done.
std::function<void(double)> progress_of(const FitOptions& options) {
  if (!options.progress) return {};
  return [&options](double fraction) { options.progress("stage one", fraction); };
}

/// The problem's own question with the unsampled parameters held.
FitOptions hold_unsampled(const Problem& problem) {
  FitOptions options = problem.options();
  options.fix.clear();
  options.bounds.clear();
  std::map<std::string, double> held;
  std::map<std::string, Normal> distributions;
  for (const Variable& parameter : problem.parameters()) {
    options.bounds[parameter.name] = {parameter.lower, parameter.upper};
    const auto value = options.unsampled.find(parameter.name);
    if (value != options.unsampled.end()) {
      options.fix[parameter.name] = std::clamp(value->second, parameter.lower, parameter.upper);
      options.prior.erase(parameter.name);
    } else if (const auto drawn = options.sampling_distribution.find(parameter.name);
               drawn != options.sampling_distribution.end()) {
      distributions.insert(*drawn);
    }
  }
  options.sampling_distribution = std::move(distributions);
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

StageOne run_without_unsampled(const Problem& problem, const model::Measurements& measurements,
                               base::ThreadPool& pool) {
  const FitOptions reduced = hold_unsampled(problem);
  StageOne result = run_stage_one(Problem(problem.model(), reduced), measurements, pool);
  const auto insert = [&](const auto& points) { return insert_held(problem, reduced.fix, points); };
  if (result.samples.cols() > 0) result.samples = insert(result.samples);
  result.best = insert(result.best);
  result.xi2 = insert(result.xi2);
  for (LocalMinimum& minimum : result.minima) minimum.xi2 = insert(minimum.xi2);
  return result;
}

/// Steps 2 and 3 among samples: Tr[R] at every one.
void sample(const Problem& problem, const model::Sweep& sweep, StageOne& result) {
  const FitOptions& options = problem.options();
  result.samples = draw_samples(problem.nonlinear(), options);
  result.trace_r = sweep.sample_squares(result.samples, progress_of(options)) /
                   static_cast<double>(sweep.measurements().rows());
}

/// Steps 2 and 3 by NLopt: the points that it asked for, and Tr[R] there.
void search(const Problem& problem, Objective& objective, std::size_t rows, StageOne& result) {
  const FitOptions& options = problem.options();
  SearchedPoints searched =
      search_globally(objective, problem.nonlinear(), options.samples, progress_of(options));
  result.samples = std::move(searched.points);
  result.trace_r = (searched.squares / static_cast<double>(rows)).unaryExpr([](double trace_r) {
    return std::isfinite(trace_r) ? trace_r : infinity;
  });
}

/// What else a model that isn't finite may need.
std::string_view way_out(const BlockModel& model) {
  if (model.new_carry() == nullptr) return "";
  return ", start nearer, or cut long segments (shoot): a state runs away along one";
}

/// Eqs. 17 and 18 where they are asked for, and Eq. 19: the best of the samples that meet them.
/// Returns Tr[R] of those that may be used, infinity elsewhere (S).
VectorXd choose_best(const Problem& problem, const model::Measurements& measurements,
                     base::ThreadPool& pool, StageOne& result) {
  if (!std::isfinite(result.trace_r.minCoeff())) {
    throw Error("the model is not finite at any of the " + std::to_string(result.trace_r.size()) +
                " samples of its nonlinear parameters; check its inputs and the bounds" +
                std::string(way_out(problem.model())));
  }
  VectorXd usable = result.trace_r;
  if (const auto& screens = problem.options().screens) {
    result.screens = screen(problem, *screens, measurements, result.samples, pool);
    check_some_accepted(*screens, *result.screens, result.trace_r);
    usable = result.screens->accepted.select(usable, infinity);
  }
  Index best = 0;
  result.best_trace_r = usable.minCoeff(&best);
  result.best = result.samples.col(best);
  return usable;
}

/// The model's guesses, moved into the bounds.
MatrixXd guess_within(const Problem& problem, const model::Measurements& measurements) {
  constexpr std::size_t enough = 4000;
  const auto [u, z] = measurements.gather(enough);
  const numerics::Box box = problem.nonlinear_box();
  MatrixXd guesses = problem.model().guess(u, z);
  for (auto guess : guesses.colwise()) guess = guess.cwiseMax(box.lower).cwiseMin(box.upper);
  return guesses;
}

}  // namespace

StageOne estimation::run_stage_one(const Problem& problem, const model::Measurements& measurements,
                                   base::ThreadPool& pool) {
  const FitOptions& options = problem.options();
  const auto is_unsampled = [&](const Variable& parameter) {
    return options.unsampled.contains(parameter.name);
  };
  if (options.start.empty() && std::ranges::any_of(problem.nonlinear(), is_unsampled)) {
    return run_without_unsampled(problem, measurements, pool);
  }
  problem.check_measurements(measurements.rows());
  const model::Sweep sweep(problem.model(), measurements, pool);
  const auto rows = static_cast<double>(measurements.rows());
  const auto n_z = static_cast<Index>(problem.model().tables().n_z());
  const bool sampled = options.samples > 0 && options.start.empty() && !problem.nonlinear().empty();

  StageOne result;
  result.xi2 = nominal_point(problem.nonlinear(), options);
  ProjectedObjective objective(sweep, VectorXd::Ones(n_z));  // R = I
  if (sampled) {
    // Steps 2 and 3: xi1 and Tr[R] at every sample.
    const bool global = options.search == Search::global;
    if (global) {
      search(problem, objective, measurements.rows(), result);
    } else {
      sample(problem, sweep, result);
    }
    const VectorXd usable = choose_best(problem, measurements, pool, result);

    // Step 4: how many minima there are, and whether they are points.
    const double count = rows * static_cast<double>(n_z);
    const numerics::Box linear = problem.linear_box();
    const Descend from_start = [&](const VectorXd& start, const IsKnown& is_known,
                                   double tolerance) {
      if (global) return descend(objective, start, problem.nonlinear_box(), half_widths(problem));
      const DescentOptions gently{.iterations = 50,
                                  .function_tolerance = tolerance,
                                  .first_radius = 0.1,
                                  .is_known = is_known};
      return minimise(objective, start, problem.nonlinear_box(), gently);
    };
    for (const Descent& minimum :
         find_minima(objective, problem, result.samples, rows * usable,
                     guess_within(problem, measurements), count, from_start)) {
      result.minima.push_back({minimum.x, objective.square_within(minimum.x, linear) / rows});
    }
    std::ranges::stable_sort(result.minima, {}, &LocalMinimum::trace_r);
    result.xi2 = result.minima.empty() ? result.best : result.minima.front().xi2;
    result.flat_directions = describe_flat_directions(objective, problem, result.xi2, count);
    result.unique_minimum = result.minima.size() == 1 && result.flat_directions.empty();
  }
  if (!std::isfinite(objective.square(result.xi2))) {
    throw Error(
        "the model is not finite at some row of the record, whatever its linear parameters; "
        "check its inputs, the fixed parameters and the bounds" +
        std::string(way_out(problem.model())));
  }
  result.xi1 = objective.linear_estimate(result.xi2);
  result.noise = (sweep.squared_residuals(result.xi1, result.xi2) / rows).cwiseSqrt();
  result.passes = sweep.passes();
  if (!sampled) {
    result.best = result.xi2;
    result.best_trace_r = result.noise.squaredNorm();
    // A linear problem has one minimum; where nothing was sampled nothing is known.
    result.unique_minimum = problem.nonlinear().empty();
    if (result.unique_minimum) result.minima.push_back({result.xi2, result.best_trace_r});
  }
  return result;
}

StageOne stage_one(const BlockModel& model, const Record& record, const FitOptions& given) {
  const FitOptions options = with_starting_values(model, record, given.stage_one_segments, given);
  const Problem problem(model, options);
  const model::Measurements measurements(problem.model(),
                                         record.select(options.stage_one_segments));
  base::ThreadPool pool(options.threads);
  return run_stage_one(problem, measurements, pool);
}

}  // namespace sepcal
