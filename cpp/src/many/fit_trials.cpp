// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/fit_trials.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "base/name_list.hpp"
#include "base/thread_pool.hpp"
#include "estimation/sampling.hpp"
#include "many/trial_errors.hpp"
#include "many/trial_lanes.hpp"
#include "many/trial_starts.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace many;  // this room's own

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using estimation::Problem;
using model::Measurements;

constexpr std::size_t trials_a_task = 512;

/// The number of trials, K.
std::size_t check_outputs(const BlockModel& model, const Record& design,
                          const std::vector<TrialOutput>& outputs) {
  std::size_t trials = 0;
  std::vector<std::string> known;
  for (const Variable& output : model.tables().outputs) {
    known.push_back(output.name);
    if (std::ranges::find(outputs, output.name, &TrialOutput::name) == outputs.end()) {
      throw Error("the trials have no output '" + output.name + "'; give its measurements");
    }
  }
  for (const TrialOutput& output : outputs) {
    if (std::ranges::find(known, output.name) == known.end()) {
      throw Error("the model has no output '" + output.name + "'; it has " +
                  base::list_names(known));
    }
    const std::size_t rows = design.length();
    const std::size_t count = rows == 0 ? 0 : output.values.size() / rows;
    if (count == 0 || count * rows != output.values.size()) {
      throw Error("output '" + output.name + "' has " + std::to_string(output.values.size()) +
                  " values; give " + std::to_string(rows) + ", the design's rows, for each trial");
    }
    if (trials != 0 && count != trials) {
      throw Error("output '" + output.name + "' has " + std::to_string(count) +
                  " trials, the others have " + std::to_string(trials));
    }
    trials = count;
  }
  return trials;
}

/// The design with the outputs that `column` gives.
template <class Column>
Record with_outputs(const Record& design, const Tables& tables, const Column& column) {
  Record record;
  for (const std::string& name : design.names()) {
    if (std::ranges::find(tables.outputs, name, &Variable::name) == tables.outputs.end()) {
      record.view(name, design.column(name));
    }
  }
  for (const Variable& output : tables.outputs) record.view(output.name, column(output.name));
  record.cut(design.segments());
  return record;
}

/// Whether nothing is asked for that lanes don't do.
bool go_in_lanes(const Problem& problem, std::size_t rows) {
  const FitOptions& options = problem.options();
  const bool one_start = options.samples == 0 || !options.start.empty();
  const bool plain = !options.coloured_errors && options.loss == Loss::squares &&
                     options.prior.empty() && options.process_noise.empty() &&
                     options.method == FitMethod::output_error && !options.screens &&
                     options.unsampled.empty() && (one_start || options.descents == 1) &&
                     options.search == Search::sampling &&
                     options.stage_one_segments == options.stage_two_segments;
  const auto is_open = [](const Variable& parameter) { return parameter.lower < parameter.upper; };
  const std::size_t measurements = rows * static_cast<std::size_t>(problem.model().tables().n_z());
  return plain && TrialLanes::take(problem.model()) &&
         std::ranges::all_of(problem.parameters(), is_open) &&
         measurements > problem.parameters().size();
}

/// The points of xi2 that trials may begin at: n_2 x S.
MatrixXd list_points(const Problem& problem) {
  const FitOptions& options = problem.options();
  const std::vector<Variable> nonlinear = problem.nonlinear();
  const bool sampled = options.samples > 0 && options.start.empty() && !nonlinear.empty();
  return sampled ? estimation::draw_samples(nonlinear, options)
                 : MatrixXd(estimation::nominal_point(nonlinear, options));
}

class DesignFits {
 public:
  DesignFits(const BlockModel& model, const Record& design, const std::vector<TrialOutput>& outputs,
             const FitOptions& options)
      : model_(model),
        design_(design),
        outputs_(outputs),
        options_(options),
        count_(check_outputs(model, design, outputs)),
        problem_(model, options),
        zeros_(design.length(), 0.0),
        pool_(options.threads),
        rows_(problem_.model(), template_record().select(options.stage_two_segments)) {
    problem_.check_measurements(rows_.rows());
    options_.threads = 1;  // of each fit
    options_.progress = {};
    for (const Variable& parameter : model.tables().parameters()) {
      const auto fixed = options.fix.find(parameter.name);
      if (fixed == options.fix.end()) free_.push_back(static_cast<Index>(result_.names.size()));
      result_.names.push_back(parameter.name);
    }
    result_.estimated = free_.size();
    const auto K = static_cast<Index>(count_);
    const auto n = static_cast<Index>(result_.names.size());
    result_.estimates = MatrixXd::Constant(K, n, not_a_number);
    result_.standard_errors = result_.estimates;
    result_.squared_residuals = MatrixXd::Constant(K, model.tables().n_z(), not_a_number);
    result_.status.resize(count_, FitStatus::not_converged);
    in_lanes_.resize(count_, 0);
    result_.rows = rows_.rows();
  }

  TrialFits run() {
    if (go_in_lanes(problem_, rows_.rows())) {
      const TrialDesign shared(problem_.model(), rows_, outputs_, count_);
      const MatrixXd starts = find_starts(shared, list_points(problem_), pool_);
      for_each_batch([&](std::size_t first, std::size_t last) {
        for (const std::size_t trial : fit_in_lanes(shared, starts, first, last)) fit_alone(trial);
      });
    } else {
      for_each_batch([&](std::size_t first, std::size_t last) {
        for (std::size_t trial = first; trial < last; ++trial) fit_alone(trial);
      });
    }
    result_.in_lanes.assign(in_lanes_.begin(), in_lanes_.end());
    return std::move(result_);
  }

 private:
  Record template_record() const {
    return with_outputs(design_, model_.tables(),
                        [&](const std::string&) { return std::span<const double>(zeros_); });
  }

  template <class FitBatch>
  void for_each_batch(const FitBatch& fit_batch) {
    std::size_t done = 0;
    pool_.for_each((count_ + trials_a_task - 1) / trials_a_task, [&](std::size_t part) {
      const std::size_t last = std::min(count_, (part + 1) * trials_a_task);
      fit_batch(part * trials_a_task, last);
      const std::lock_guard lock(mutex_);
      done += last - part * trials_a_task;
      if (problem_.options().progress) {
        problem_.options().progress("trials",
                                    static_cast<double>(done) / static_cast<double>(count_));
      }
    });
  }

  /// Returns what is left for fit(), in order.
  std::vector<std::size_t> fit_in_lanes(const TrialDesign& shared, const MatrixXd& starts,
                                        std::size_t first, std::size_t last) {
    TrialLanes lanes(problem_, shared);
    TrialErrors errors(problem_, shared.rows());
    std::vector<std::size_t> open;
    std::vector<std::size_t> left = lanes.fit(first, last, starts, [&](const TrialEnd& end) {
      const auto message = errors.judge(end);
      if (!message) return open.push_back(end.trial);
      const auto row = static_cast<Index>(end.trial);
      for (const auto& [name, value] : options_.fix) {
        const auto at = std::ranges::find(result_.names, name) - result_.names.begin();
        result_.estimates(row, at) = value;
      }
      for (Index k = 0; k < end.x.size(); ++k) {
        result_.estimates(row, free_[static_cast<std::size_t>(k)]) = end.x[k];
        result_.standard_errors(row, free_[static_cast<std::size_t>(k)]) =
            errors.standard_errors()[k];
      }
      result_.squared_residuals.row(row) = end.squares.transpose();
      result_.status[end.trial] = FitStatus::converged;
      in_lanes_[end.trial] = 1;
      if (!message->empty()) note(result_.messages, end.trial, *message);
    });
    left.insert(left.end(), open.begin(), open.end());
    std::ranges::sort(left);
    return left;
  }

  void fit_alone(std::size_t trial) {
    const auto z = [&](const std::string& name) {
      const auto output = std::ranges::find(outputs_, name, &TrialOutput::name);
      return output->values.subspan(trial * design_.length(), design_.length());
    };
    try {
      const Fit one = fit(model_, with_outputs(design_, model_.tables(), z), options_);
      const auto row = static_cast<Index>(trial);
      result_.estimates.row(row) = one.values().transpose();
      for (std::size_t k = 0; k < one.parameters.size(); ++k) {
        result_.standard_errors(row, static_cast<Index>(k)) = one.parameters[k].standard_error;
      }
      for (std::size_t j = 0; j < one.rmse.size(); ++j) {
        const double rmse = one.rmse[j].value;
        result_.squared_residuals(row, static_cast<Index>(j)) =
            rmse * rmse * static_cast<double>(one.rows);
      }
      result_.status[trial] = one.status;
      if (!one.message.empty()) note(result_.messages, trial, one.message);
    } catch (const Error& error) {
      note(result_.failures, trial, error.what());
    }
  }

  void note(std::map<std::size_t, std::string>& notes, std::size_t trial, std::string text) {
    const std::lock_guard lock(mutex_);
    notes.emplace(trial, std::move(text));
  }

  const BlockModel& model_;
  const Record& design_;
  const std::vector<TrialOutput>& outputs_;
  FitOptions options_;
  std::size_t count_;
  Problem problem_;
  std::vector<double> zeros_;  // outputs of a design without measurements
  base::ThreadPool pool_;
  Measurements rows_;
  TrialFits result_;
  std::vector<Index> free_;              // places of the free parameters among all
  std::vector<unsigned char> in_lanes_;  // bytes: threads write side by side
  std::mutex mutex_;
};

}  // namespace

TrialFits fit_trials(const BlockModel& model, const Record& design,
                     const std::vector<TrialOutput>& outputs, const FitOptions& options) {
  return DesignFits(model, design, outputs, options).run();
}

}  // namespace sepcal
