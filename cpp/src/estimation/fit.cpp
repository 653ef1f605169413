// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/fit.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "base/excerpt.hpp"
#include "base/sentences.hpp"
#include "estimation/covariance.hpp"
#include "estimation/curvature.hpp"
#include "estimation/filter_error.hpp"
#include "estimation/fitted_parameters.hpp"
#include "estimation/likelihood.hpp"
#include "estimation/minima.hpp"
#include "estimation/model_trial.hpp"
#include "estimation/plausibility.hpp"
#include "estimation/prior_checks.hpp"
#include "estimation/process_noise.hpp"
#include "estimation/runaway.hpp"
#include "estimation/sampling.hpp"
#include "estimation/stage_one.hpp"
#include "estimation/stage_two.hpp"
#include "estimation/standard_errors.hpp"

namespace sepcal {

using namespace estimation;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What takes rows all at once gets an excerpt of a record that may be longer than memory; not of a
/// model with a state, whose trajectories an excerpt would cut.
class Sample {
 public:
  Sample(const BlockModel& model, const model::Measurements& all) : all_(all) {
    if (model.new_carry() != nullptr) return;
    const Record part = base::excerpt(all.record());
    if (part.rows() < all.rows()) excerpt_.emplace(model, part);
  }

  const model::Measurements& measurements() const { return excerpt_ ? *excerpt_ : all_; }

 private:
  const model::Measurements& all_;
  std::optional<model::Measurements> excerpt_;
};

/// Where as many parameters as measurements are free, nothing is left that would tell of the noise:
/// any readings fit exactly. Empty where some are left, and where the noise was given.
std::string describe_no_freedom(const Problem& problem, const Covariances& covariances,
                                std::size_t measurements) {
  if (problem.noise().size() > 0 || covariances.freedom > 0.0) return "";
  return std::to_string(measurements) + " measurements for " +
         std::to_string(problem.parameters().size()) +
         " parameters leave nothing to judge the fit by: any readings would fit as well (log more, "
         "or fix parameters)";
}

void describe(Fit& result, const BlockModel& model, const Problem& problem,
              const model::Measurements& measurements, const StageTwo& two,
              base::ThreadPool& pool) {
  const auto rows = static_cast<double>(measurements.rows());
  const model::Sweep sweep(problem.model(), measurements, pool);
  const Sample sample(problem.model(), measurements);
  const model::Sweep sampled_sweep(problem.model(), sample.measurements(), pool);
  const SampledRows sampled{sampled_sweep,
                            rows / static_cast<double>(sample.measurements().rows())};
  const Covariances covariances = find_covariances(problem, sweep, sampled, two);
  const StandardErrors errors = find_standard_errors(problem, sweep, sampled, two, covariances);
  fill_parameters(result, model, problem,
                  {two.x, two.at_bound, covariances.inside, errors.believed, covariances.white,
                   covariances.noise_model, errors.blocks});

  // With the columns of parameters at a bound: a bound may hold what the record leaves open.
  std::vector<std::string> names;
  for (const Variable& parameter : problem.parameters()) names.push_back(parameter.name);
  const VectorXd scale = plausible_scale(problem.parameters(), two.factors, measurements);
  result.identifiability = judge_identifiability(covariances.tangent, names, scale, two.at_bound);

  const Index n_1 = problem.model().tables().n_1();
  const Index n_2 = problem.model().tables().n_2();
  // The factors' rows are weighted by a loss.
  const VectorXd sums = problem.options().loss == Loss::squares
                            ? squares(two.factors)
                            : sweep.squared_residuals(two.x.head(n_1), two.x.tail(n_2));
  const VectorXd rmse = (sums / rows).cwiseSqrt();
  result.rmse = by_output(model.tables(), rmse);
  result.noise = by_output(model.tables(), two.noise);
  result.cost = two.cost;
  result.second_stage = two.method;
  result.iterations = two.iterations;
  result.noise_iterations = two.noise_iterations;
  result.rows = measurements.rows();
  result.stage_two_passes = two.passes;
  std::vector<std::string> sentences = two.sentences;
  const std::string no_freedom = describe_no_freedom(
      problem, covariances, measurements.rows() * problem.model().tables().outputs.size());
  sentences.push_back(no_freedom);
  sentences.push_back(result.identifiability.message());
  sentences.push_back(describe_other_minima(problem, result.stage_one.minima));
  const bool are_asked_for = problem.options().coloured_errors;  // standard errors
  if (are_asked_for && result.identifiability.unobservable.empty()) {
    sentences.push_back(describe_curvature(problem, sweep, two));
  }
  std::ranges::copy(errors.sentences, std::back_inserter(sentences));
  std::ranges::move(judge_priors(result.parameters, problem.options()),
                    std::back_inserter(sentences));
  result.message = base::join_sentences(sentences);
  result.last_passes = sweep.passes();
  const bool is_open = !result.identifiability.unobservable.empty() || !no_freedom.empty();
  result.status = is_open           ? FitStatus::not_identifiable
                  : two.converged() ? FitStatus::converged
                                    : FitStatus::not_converged;
}

Fit fit_output_error(const BlockModel& model, const Record& record, const FitOptions& given) {
  const FitOptions options = with_starting_values(model, record, given.stage_two_segments, given);
  const Problem problem(model, options);
  base::ThreadPool pool(options.threads);
  const model::Measurements second(problem.model(), record.select(options.stage_two_segments));
  problem.check_measurements(second.rows());
  std::map<std::string, double> start = options.start;  // of what the bounds may say nothing
  start.insert(options.unsampled.begin(), options.unsampled.end());
  try_model(problem.model(), second, start);

  Fit result;
  if (options.stage_one_segments == options.stage_two_segments) {
    result.stage_one = run_stage_one(problem, second, pool);
  } else {
    const model::Measurements first(problem.model(), record.select(options.stage_one_segments));
    result.stage_one = run_stage_one(problem, first, pool);
  }
  const StageTwo two = run_stage_two(problem, second, result.stage_one, pool);
  describe(result, model, problem, second, two, pool);
  const Record fitted = record.select(options.stage_two_segments);
  allow_for_process_noise(result, model, fitted, options);
  warn_of_coarse_steps(result, model, fitted);
  warn_of_runaway(result, model, fitted);
  return result;
}

}  // namespace

Fit fit(const BlockModel& model, const Record& record, const FitOptions& options) {
  check_process_noise(model, options);
  if (options.method == FitMethod::filter_error) return fit_filter_error(model, record, options);
  return fit_output_error(model, record, options);
}

}  // namespace sepcal
