// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/rivals/single_stage.hpp"

#include <cmath>

#include "base/name_list.hpp"
#include "base/thread_pool.hpp"
#include "estimation/alternation.hpp"
#include "estimation/likelihood.hpp"
#include "estimation/minimise.hpp"
#include "estimation/objective.hpp"
#include "estimation/plausibility.hpp"
#include "estimation/problem.hpp"
#include "estimation/refine.hpp"
#include "estimation/sqp.hpp"
#include "model/measurements.hpp"
#include "model/sweep.hpp"
#include "rivals/noise_of.hpp"
#include "sepcal/error.hpp"

namespace sepcal::rivals {

using Eigen::Index;
using Eigen::VectorXd;

std::string_view to_string(Solver solver) {
  return solver == Solver::slsqp ? "slsqp" : "levenberg_marquardt";
}

std::string_view to_string(CostScale scale) { return scale == CostScale::sum ? "sum" : "mean"; }

namespace {

FitOptions fit_options(const SingleStageOptions& options) {
  FitOptions asked;
  asked.bounds = options.bounds;
  asked.fix = options.fix;
  asked.noise = options.noise;
  asked.stage_one_segments = asked.stage_two_segments = options.segments;
  asked.iterations = options.evaluations;
  asked.noise_tolerance = options.noise_tolerance;
  asked.noise_iterations = options.noise_iterations;
  asked.threads = options.threads;
  return asked;
}

/// A point of the single stage, as alternate() steps it.
struct Point {
  VectorXd x;            // free parameters
  VectorXd noise;        // n_z
  bool refined = true;   // the last minimisation converged
  bool settled = false;  // R did
  int evaluations = 0;
  int noise_iterations = 0;
};

class Programme {
 public:
  Programme(const estimation::Problem& problem, const model::Sweep& sweep,
            const SingleStageOptions& options)
      : problem_(problem), sweep_(sweep), options_(options) {}

  bool noise_given() const { return problem_.noise().size() > 0; }

  Point begin(const VectorXd& x) const {
    const VectorXd noise = noise_given() ? problem_.noise() : VectorXd::Ones(sweep_.tables().n_z());
    return {problem_.box().clip(x), noise};
  }

  Point find_minimum(Point at) const {
    estimation::JointObjective objective(sweep_, at.noise.cwiseInverse());
    const estimation::Descent end = options_.solver == Solver::slsqp
                                        ? descend_by_slsqp(objective, at.x)
                                        : descend_to_minimum(objective, at.x);
    at.x = end.x;
    at.refined = end.converged;
    at.evaluations += end.iterations;
    return at;
  }
  Point follow_minimum(Point at) const { return find_minimum(std::move(at)); }

  VectorXd noise_at(const Point& at) const { return noise_of(squares(at), sweep_.measurements()); }
  void take_noise(Point& at, VectorXd noise) const { at.noise = std::move(noise); }

  /// J of Eq. 6.
  double cost(const Point& at) const {
    const VectorXd weighted = squares(at).cwiseQuotient(at.noise.cwiseAbs2());
    return 0.5 * weighted.sum() + rows() * at.noise.array().log().sum();
  }

 private:
  double rows() const { return static_cast<double>(sweep_.measurements().rows()); }

  VectorXd squares(const Point& at) const {
    const Index n_1 = sweep_.tables().n_1();
    return sweep_.squared_residuals(at.x.head(n_1), at.x.tail(at.x.size() - n_1));
  }

  /// Ceres clips steps to the box and may stand still beside a minimum: then SLSQP goes on.
  estimation::Descent descend_to_minimum(estimation::JointObjective& objective,
                                         const VectorXd& x) const {
    estimation::Descent end =
        estimation::minimise(objective, x, problem_.box(), {.iterations = options_.evaluations});
    if (!std::isfinite(end.square)) return end;
    const Index n_1 = sweep_.tables().n_1();
    const VectorXd scale = estimation::plausible_scale(
        problem_.parameters(),
        sweep_.tangent_factors(end.x.head(n_1), end.x.tail(end.x.size() - n_1)),
        sweep_.measurements());
    const estimation::Refinement last = estimation::refine(objective, end.x, problem_.box(), scale);
    end.iterations += last.iterations;
    if (last.converged) {
      end.x = last.x;
      end.converged = true;
      return end;
    }
    estimation::Descent along = descend_by_slsqp(objective, end.x);
    along.iterations += end.iterations;
    return along;
  }

  estimation::Descent descend_by_slsqp(estimation::Objective& objective, const VectorXd& x) const {
    return estimation::descend_by_sqp(objective, x, problem_.box(), VectorXd::Ones(x.size()),
                                      {.rows = options_.cost == CostScale::mean ? rows() : 1.0,
                                       .evaluations = options_.evaluations});
  }

  const estimation::Problem& problem_;
  const model::Sweep& sweep_;
  const SingleStageOptions& options_;
};

/// Throws Error for a name that is no parameter or is fixed, and a start that is not finite.
void check_start(const Tables& tables, const std::map<std::string, double>& start,
                 const std::map<std::string, double>& fixed) {
  std::vector<std::string> names;
  for (const Variable& parameter : tables.parameters()) names.push_back(parameter.name);
  for (const auto& [name, value] : start) {
    if (!base::is_among(names, name)) {
      throw Error("start: there is no parameter '" + name +
                  "'; there are: " + base::list_names(names));
    }
    if (fixed.contains(name)) throw Error("start: '" + name + "' is fixed");
    if (!std::isfinite(value)) throw Error("start: '" + name + "' must be finite");
  }
}

}  // namespace

SingleStageFit fit_single_stage(const BlockModel& model, const Record& record,
                                const std::map<std::string, double>& start,
                                const SingleStageOptions& options) {
  check_start(model.tables(), start, options.fix);
  if (options.evaluations < 1) throw Error("evaluations must be at least 1");
  const FitOptions asked = fit_options(options);
  const estimation::Problem problem(model, asked);
  base::ThreadPool pool(options.threads);
  const model::Measurements measurements(
      problem.model(),
      model::with_constant_outputs(model.tables(), record.select(options.segments)));
  problem.check_measurements(measurements.rows());
  const model::Sweep sweep(problem.model(), measurements, pool);

  VectorXd x = VectorXd::Zero(static_cast<Index>(problem.parameters().size()));
  for (Index k = 0; k < x.size(); ++k) {
    const auto given = start.find(problem.parameters()[static_cast<std::size_t>(k)].name);
    if (given != start.end()) x[k] = given->second;
  }
  Programme programme(problem, sweep, options);
  const Point end = estimation::alternate(programme, programme.begin(x), asked);

  SingleStageFit fit;
  fit.converged = end.refined && end.settled;
  fit.cost = programme.cost(end);
  fit.evaluations = end.evaluations;
  fit.noise_iterations = end.noise_iterations;
  fit.estimates.resize(static_cast<Index>(model.tables().parameters().size()));
  Index next = 0;
  for (const Variable& parameter : model.tables().parameters()) {
    const auto held = options.fix.find(parameter.name);
    const auto place = static_cast<Index>(fit.names.size());
    fit.estimates[place] = held != options.fix.end() ? held->second : end.x[next++];
    fit.names.push_back(parameter.name);
  }
  for (std::size_t j = 0; j < model.tables().outputs.size(); ++j) {
    fit.noise.push_back({model.tables().outputs[j].name, end.noise[static_cast<Index>(j)]});
  }
  return fit;
}

}  // namespace sepcal::rivals
