// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/filter_error.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "base/name_list.hpp"
#include "base/sentences.hpp"
#include "estimation/block_errors.hpp"
#include "estimation/filter_error_start.hpp"
#include "estimation/fitted_parameters.hpp"
#include "estimation/innovation_summary.hpp"
#include "estimation/prior_checks.hpp"
#include "estimation/runaway.hpp"
#include "estimation/sampling.hpp"
#include "estimation/scored_estimate.hpp"
#include "estimation/scoring.hpp"
#include "estimation/theta_layout.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {

std::unique_ptr<InnovationModel> innovations_of(const BlockModel& model, const Record& record,
                                                const FitOptions& options) {
  if (options.loss != Loss::squares) {
    throw Error(
        "filter error takes squares alone, as a reading that is forgiven has moved the filter "
        "already; leave bad readings out (NaN), or fit by output error");
  }
  std::unique_ptr<InnovationModel> innovations = model.innovations(record);
  if (innovations == nullptr) {
    throw Error("filter error needs a model with a state; fit this one by output error");
  }
  if (model.process_noises().empty()) {
    throw Error(
        "filter error needs process noise, and the model's table `noise` is empty; name there what "
        "drives its states, or fit by output error");
  }
  return innovations;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Readings of each output (n_z). Throws Error for one that is neither finite nor missing, for an
/// output without any, and where there are fewer than parameters.
void check_readings(const Problem& problem, const Record& record) {
  std::size_t count = 0;
  for (const Variable& output : problem.model().tables().outputs) {
    const auto values = record.column(output.name);
    std::size_t there = 0;
    for (const Segment& segment : record.segments()) {
      for (std::size_t row = segment.first; row < segment.last; ++row) {
        if (std::isinf(values[row])) {
          throw Error("column '" + output.name + "' is infinite in row " + std::to_string(row) +
                      " (counted from 0); mend it, or leave it empty (NaN) for a missing reading");
        }
        if (!std::isnan(values[row])) ++there;
      }
    }
    if (there == 0) {
      throw Error("output '" + output.name + "' has no reading; leave it out of the outputs");
    }
    count += there;
  }
  if (count >= problem.parameters().size()) return;
  throw Error("the record has " + std::to_string(count) + " readings, fewer than the " +
              std::to_string(problem.parameters().size()) +
              " parameters; log more or fix parameters");
}

/// Outputs that read the same throughout.
std::vector<std::string> describe_constants(const BlockModel& model, const Record& record) {
  std::vector<std::string> names;
  for (const Variable& output : model.tables().outputs) {
    const auto values = record.column(output.name);
    double least = std::numeric_limits<double>::infinity();
    double most = -least;
    for (const Segment& segment : record.segments()) {
      for (const double value : values.subspan(segment.first, segment.rows())) {
        if (std::isnan(value)) continue;
        least = std::min(least, value);
        most = std::max(most, value);
      }
    }
    if (least == most) names.push_back(output.name);
  }
  if (names.empty()) return {};
  const bool one = names.size() == 1;
  return {base::list_names(names) + (one ? " reads" : " read") +
          " the same in every row, as nothing that is measured does: leave " +
          (one ? "it" : "them") + " out of the outputs"};
}

/// A record that is too short for what is asked of it.
std::vector<std::string> describe_length(const Record& record) {
  constexpr std::size_t few = 24;  // rows
  if (record.rows() >= few) return {};
  return {std::to_string(record.rows()) +
          " rows hardly tell noise of the states from the outputs': sizes of noises and standard "
          "errors are rough"};
}

/// One fit: theta's places, and what comes of them.
class FilterError {
 public:
  FilterError(const BlockModel& model, const Record& record, const FitOptions& options)
      : model_(model),
        record_(record),
        problem_(model, options),
        innovations_(innovations_of(model, record, options)),
        layout_(model, problem_, *innovations_) {
    check_readings(problem_, record);
  }

  Fit run() {
    const FilterErrorStart start = start_filter_error(model_, record_, problem_, *innovations_);
    layout_.hold_silent(start.theta);
    Scoring scoring{.model = *innovations_,
                    .free = free(),
                    .box = layout_.box(start.floor),
                    .prior = layout_.prior(),
                    .iterations = options().iterations};
    if (options().progress) {
      scoring.progress = [this](int iteration) {
        options().progress("filter error", 1.0 - std::exp(-0.1 * iteration));
      };
    }
    Scored at = minimise_by_scoring(scoring, start.theta);
    if (options().hessian == Hessian::observed) at = finish_by_newton(scoring, std::move(at));
    return describe(scoring, at, start);
  }

 private:
  const FitOptions& options() const { return problem_.options(); }
  Index n() const { return layout_.n(); }

  const std::vector<Index>& free() const { return layout_.free(); }

  /// Score rows by blocks that are longer than the innovations remember.
  std::vector<TriangularFactor> block_factors(const Scored& at, double memory,
                                              const std::vector<Index>& inside) const {
    std::vector<Index> columns;
    for (const Index i : inside) columns.push_back(free()[static_cast<std::size_t>(i)]);
    columns.push_back(innovations_->size());
    const auto samples = static_cast<Index>(record_.rows());
    const int blocks = std::isfinite(memory) ? choose_blocks(samples, memory) : 0;
    return score_blocks(*innovations_, record_, at.theta, columns, blocks);
  }

  Fit describe(const Scoring& scoring, const Scored& at, const FilterErrorStart& start) const {
    Fit result;
    result.method = FitMethod::filter_error;
    if (start.output_error) {
      result.stage_one = start.output_error->stage_one;
      result.stage_two_passes = start.output_error->stage_two_passes;
    }
    const bool finite = std::isfinite(at.cost);
    const VectorXd outputs = at.theta.tail(innovations_->outputs()).array().exp();
    const InnovationSummary summary =
        finite ? summarise(*innovations_, model_, record_, at.theta) : InnovationSummary{};
    const std::vector<Estimated> estimated = layout_.estimated();
    const ScoredErrors errors = find_scored_errors(
        scoring, at, estimated, options(), [&](const std::vector<Index>& inside) {
          return block_factors(at, summary.memory, inside);
        });
    if (finite) {
      result.identifiability = judge_scored(at, estimated, summary.whitened_square(outputs));
    }
    fill(result, at, errors);
    fill_noise(result, scoring, at, estimated, errors);
    result.rmse = by_output(
        model_.tables(),
        finite ? summary.rmse()
               : VectorXd::Constant(outputs.size(), std::numeric_limits<double>::quiet_NaN()));
    result.noise = by_output(model_.tables(), outputs);
    const double constant = likelihood_constant(at.readings);
    result.cost = at.cost;
    result.log_likelihood = -at.cost - constant;
    result.log_likelihood_without = -start.cost_without - constant;
    result.iterations = at.iterations;
    result.rows = record_.rows();

    std::vector<std::string> sentences;
    if (!finite) {
      sentences.push_back(describe_stop(at.row));
    } else if (!at.converged) {
      sentences.push_back(describe_no_maximum(options()));
    }
    std::ranges::move(describe_constants(model_, record_), std::back_inserter(sentences));
    sentences.push_back(result.identifiability.message());
    std::ranges::move(describe_length(record_), std::back_inserter(sentences));
    std::ranges::move(describe_floors(at, scoring, estimated, options()),
                      std::back_inserter(sentences));
    std::ranges::move(describe_noises(result.noise_sizes), std::back_inserter(sentences));
    std::ranges::copy(errors.sentences, std::back_inserter(sentences));
    std::ranges::move(judge_priors(result.parameters, options()), std::back_inserter(sentences));
    result.message = base::join_sentences(sentences);
    result.status = !result.identifiability.unobservable.empty() ? FitStatus::not_identifiable
                    : finite && at.converged                     ? FitStatus::converged
                                                                 : FitStatus::not_converged;
    warn_of_coarse_steps(result, model_, record_);
    return result;
  }

  /// The model's parameters of what was estimated.
  void fill(Fit& result, const Scored& at, const ScoredErrors& errors) const {
    const Index k = layout_.free_parameters();
    std::vector<Index> own;  // places within those inside
    std::vector<Index> places;
    for (std::size_t i = 0; i < errors.inside.size(); ++i) {
      if (errors.inside[i] >= k) continue;
      own.push_back(static_cast<Index>(i));
      places.push_back(errors.inside[i]);
    }
    const VectorXd x = at.theta(std::vector<Index>(free().begin(), free().begin() + k));
    const std::vector<bool> at_bound(at.at_bound.begin(), at.at_bound.begin() + k);
    const MatrixXd white = errors.white(own, own);
    fill_parameters(
        result, model_, problem_,
        {x, at_bound, places, errors.believed(own, own), white, white, errors.blocks(own, own)});
  }

  void fill_noise(Fit& result, const Scoring& scoring, const Scored& at,
                  const std::vector<Estimated>& estimated, const ScoredErrors& errors) const {
    for (Index k = n(); k < innovations_->size(); ++k) {
      const auto place = std::ranges::find(free(), k);
      if (place != free().end()) {
        result.noise_sizes.push_back(
            size_of(at, scoring, estimated, errors, place - free().begin()));
        continue;
      }
      NoiseSize held{.name = layout_.name_of(k),
                     .unit = layout_.noise(k - n()).unit,
                     .value = std::exp(at.theta[k])};
      held.standard_error = std::numeric_limits<double>::quiet_NaN();
      result.noise_sizes.push_back(std::move(held));
    }
  }

  const BlockModel& model_;
  const Record& record_;
  Problem problem_;
  std::unique_ptr<InnovationModel> innovations_;
  ThetaLayout layout_;
};

}  // namespace

Fit fit_filter_error(const BlockModel& model, const Record& record, const FitOptions& given) {
  const Record fitted = record.select(given.stage_two_segments);
  FitOptions options = with_starting_values(model, record, given.stage_two_segments, given);
  options.stage_one_segments.clear();  // one record for all of it
  options.stage_two_segments.clear();
  return FilterError(model, fitted, options).run();
}

}  // namespace sepcal::estimation
