// SPDX-License-Identifier: BSD-3-Clause
// Tracks of models of samples, whose parameters are the state.
#include "sepcal/states/track.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/name_list.hpp"
#include "base/parameter_values.hpp"
#include "base/stop.hpp"
#include "model/fixed_model.hpp"
#include "model/measurements.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/error.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/information_form.hpp"
#include "sepcal/states/iterated_update.hpp"
#include "states/band_track.hpp"
#include "states/change_watch.hpp"
#include "states/information_track.hpp"
#include "states/joint_track.hpp"
#include "states/likelihood_track.hpp"

namespace sepcal {
namespace {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void check_start(const Tables& tables, const StreamStart& start) {
  const std::vector<Variable> parameters = tables.parameters();
  for (const Variable& parameter : parameters) {
    if (std::ranges::find(start.names, parameter.name) != start.names.end()) continue;
    throw Error("the start has no '" + parameter.name + "'; it has " +
                base::list_first(start.names, 12) + ": start from this model and record");
  }
  std::vector<std::string> others;
  for (const std::string& name : start.names) {
    if (std::ranges::find(parameters, name, &Variable::name) == parameters.end()) {
      others.push_back(name);
    }
  }
  if (others.empty()) return;
  throw Error("the start has parameters that this record's model has not: " +
              base::list_first(others, 12));
}

/// Throws Error where a trajectory begins that the start doesn't know.
void check_trajectories(const TrajectoryPlan& plan, const StreamStart& start) {
  for (const int i : plan.integrated()) {
    const std::string& state = plan.model().states[static_cast<std::size_t>(i)].name;
    const std::string name = plan.start_name(state, plan.trajectories() - 1);
    if (std::ranges::find(start.names, name) != start.names.end()) continue;
    throw Error("rls linearises at the trajectories of the start, which knows none from '" + name +
                "' on; take ekf, iekf or srif");
  }
}

/// Throws Error for what a filter of states takes.
void check_linearised(const TrackOptions& options) {
  const auto refuse = [](const std::string& name, const char* what) {
    throw Error("rls integrates no noise and starts where the batch does: leave the " +
                std::string(what) + " '" + name + "' out, or take ekf, iekf or srif");
  };
  if (!options.process_noise.empty()) refuse(options.process_noise.begin()->first, "process noise");
  if (!options.initial_states.empty()) refuse(options.initial_states.begin()->first, "state");
}

constexpr double least_memory = 20.0;  // rows

void check_memory(const TrackOptions& options) {
  if (options.method == TrackMethod::rml || options.method == TrackMethod::rft) {
    throw OptionError({Option{"memory"}, " is of rls, ekf, iekf and srif; take forgetting"});
  }
  if (options.forgetting != 1.0) {
    throw OptionError({Option{"memory"}, " forgets in its own way; leave forgetting out"});
  }
  if (!(options.memory >= least_memory) || std::isinf(options.memory)) {
    throw OptionError({Option{"memory"}, " is in rows; give 20 or more"});
  }
}

/// Throws OptionError for what another method takes.
void check_of_method(const TrackOptions& options) {
  const TrackOptions by_default;
  const auto refuse = [&](bool is_given, const char* option, TrackMethod method) {
    if (!is_given || options.method == method) return;
    throw OptionError({Option{option}, " is of " + std::string(to_string(method)) +
                                           " alone; leave it out, or take " +
                                           std::string(to_string(method))});
  };
  if (!options.walk.empty() && !is_filter(options.method)) {
    throw OptionError({Option{"walk"}, " is of ekf, iekf and srif; leave it out, or take ekf"});
  }
  if (options.changes != TrackChanges::ignore && !is_filter(options.method)) {
    throw OptionError({Option{"changes"}, " is of ekf, iekf and srif; leave it out, or take ekf"});
  }
  if (!(options.forgetting > 0.0 && options.forgetting <= 1.0)) {
    throw OptionError({Option{"forgetting"},
                       " multiplies the weight of older rows at each new one: above 0, at most 1"});
  }
  if (options.memory != 0.0) check_memory(options);
  refuse(options.differentiate, "differentiate", TrackMethod::rft);
  refuse(options.every != by_default.every, "every", TrackMethod::rml);
  refuse(options.iterations.iterations != by_default.iterations.iterations, "row_iterations",
         TrackMethod::iekf);
  refuse(options.iterations.tolerance != by_default.iterations.tolerance, "tolerance",
         TrackMethod::iekf);
}

std::vector<std::string> free_names(const StreamStart& start) {
  std::vector<std::string> names;
  for (const int k : start.free) names.push_back(start.names[static_cast<std::size_t>(k)]);
  return names;
}

std::map<std::string, double> held(const StreamStart& start) {
  std::map<std::string, double> values;
  for (std::size_t k = 0; k < start.names.size(); ++k) {
    const auto place = static_cast<int>(k);
    if (std::ranges::find(start.free, place) != start.free.end()) continue;
    values[start.names[k]] = start.xi[place];
  }
  return values;
}

/// A model of samples along a record: [H | r] of one sample, whitened, at any point of what is
/// free.
class Samples {
 public:
  Samples(const BlockModel& model, const Record& record, const StreamStart& start, VectorXd noise)
      : model_(model, held(start)), measurements_(model_, record), noise_(std::move(noise)) {}

  const model::Measurements& measurements() const { return measurements_; }
  std::unique_ptr<Carry> new_carry() const { return model_.new_carry(); }
  const VectorXd& noise() const { return noise_; }

  /// Of every row of a range, output by output within a row.
  MatrixXd rows(const model::Measurements::Range& range, const VectorXd& x, Carry* carry) {
    const Index n_1 = model_.tables().n_1();
    const auto count = static_cast<Index>(range.rows);
    const Index n_z = noise_.size();
    MatrixXd out(n_z * count, x.size() + 1);
    const VectorXd xi1 = x.head(n_1);
    const VectorXd xi2 = x.tail(x.size() - n_1);
    model_.evaluate(measurements_.block(range, pointers_), values_of(xi2), values_of(xi1), carry,
                    out);
    MatrixXd sorted(out.rows(), out.cols());
    for (Index j = 0; j < n_z; ++j) {
      const auto z = measurements_.output(static_cast<int>(j), range);
      for (Index i = 0; i < count; ++i) {
        auto row = sorted.row(i * n_z + j);
        row = out.row(j * count + i);
        row[x.size()] = z[static_cast<std::size_t>(i)] - row[x.size()] - row.head(n_1).dot(xi1);
        row /= noise_[j];
      }
    }
    return sorted;
  }

 private:
  model::FixedModel model_;
  model::Measurements measurements_;
  VectorXd noise_;
  std::vector<const double*> pointers_;
};

/// Estimates of what is free among all parameters, in the model's order.
class Collected {
 public:
  Collected(const Record& record, const StreamStart& start, int n_z)
      : record_(record),
        start_(start),
        track_(states::empty_track(start.names, record.rows() - start.rows, n_z)) {}

  void append(std::size_t row, const VectorXd& x, const VectorXd& deviation, const VectorXd& e) {
    VectorXd estimate = start_.xi;
    VectorXd all = VectorXd::Zero(estimate.size());
    estimate(start_.free) = x;
    all(start_.free) = deviation;
    states::append(track_, row, record_, estimate, all, e);
  }

  Track& track() { return track_; }

 private:
  const Record& record_;
  const StreamStart& start_;
  Track track_;
};

/// Rows linearised at the start, absorbed one sample after another.
void track_linearised(Samples& samples, const StreamStart& start, const TrackOptions& options,
                      Collected& collected) {
  const VectorXd x = start.xi(start.free);
  const Index n_z = samples.noise().size();
  states::InformationTrack filter(start.R);
  states::Forgetting forgetting(options);
  for (const auto& chunk : samples.measurements().chunks()) {
    const auto carry = samples.new_carry();
    for (const auto& range : chunk) {
      base::heed_stop();
      const MatrixXd rows = samples.rows(range, x, carry.get());
      for (std::size_t i = 0; i < range.rows; ++i) {
        if (range.offset + i < start.rows) continue;
        const MatrixXd sample = rows.middleRows(static_cast<Index>(i) * n_z, n_z);
        filter.forget(forgetting.next());
        const VectorXd before = filter.solution();
        const VectorXd e = sample.rightCols<1>() - sample.leftCols(x.size()) * before;
        if (options.memory > 0.0) {
          forgetting.follow(filter.whitened(sample), static_cast<int>(n_z));
        }
        if (!filter.absorb(sample)) ++collected.track().refused;
        collected.append(range.first + i, x + filter.solution(), filter.deviations(),
                         e.cwiseProduct(samples.noise()));
      }
    }
  }
}

/// Every sample linearised where the filter is.
template <class Form>
class SampleStream {
 public:
  SampleStream(Samples& samples, const Record& record, const StreamStart& start,
               const TrackOptions& options)
      : samples_(samples),
        record_(record),
        start_(start),
        options_(options),
        nothing_(VectorXd::Zero(samples.noise().size())),
        names_(free_names(start)),
        walk_(states::walk_of(names_, options)),
        watch_(record, names_, walk_.size(), options.changes),
        forgetting_(options) {}

  void run(Collected& collected) {
    Filter<Dynamic, Form> filter(start_.xi(start_.free), Form::of_information_root(start_.R));
    for (const auto& chunk : samples_.measurements().chunks()) {
      for (const auto& range : chunk) {
        for (std::size_t i = 0; i < range.rows; ++i) {
          base::heed_stop();
          if (range.offset + i < start_.rows) continue;
          rows_.push_back({range.first + i, 1, range.offset + i, range.starts_segment && i == 0});
          update(filter, collected);
        }
      }
    }
    collected.track().changes = std::move(watch_).changes();
  }

 private:
  /// By the last of the rows.
  void update(Filter<Dynamic, Form>& filter, Collected& collected) {
    const std::size_t at = rows_.size() - 1;
    step_to(filter, at, forgetting_.next());
    const Linearisation<Dynamic, Dynamic> before = expected(at, filter.x());
    const MatrixXd P = watch_.looks() ? filter.covariance() : MatrixXd();
    const Innovation<Dynamic> innovation = absorb(filter, at, before);
    forgetting_.follow(innovation.w, innovation.count);
    collected.track().refused += innovation.status == FilterStatus::refused ? 1 : 0;
    collected.track().not_converged += innovation.status == FilterStatus::not_converged ? 1 : 0;
    watch_.update(
        filter, P, before.jacobian, nothing_, innovation, rows_[at].first,
        [&](Filter<Dynamic, Form>& anew, std::size_t count) { return run_again(anew, count); });
    collected.append(rows_[at].first, filter.x(), filter.covariance().diagonal().cwiseSqrt(),
                     -before.value.cwiseProduct(samples_.noise()));
  }

  /// The last rows again: V_m of them.
  double run_again(Filter<Dynamic, Form>& filter, std::size_t count) {
    double cost = 0.0;
    for (std::size_t at = rows_.size() - count; at < rows_.size(); ++at) {
      step_to(filter, at, forgetting_.constant());
      const Innovation<Dynamic> innovation = absorb(filter, at, expected(at, filter.x()));
      if (innovation.status != FilterStatus::refused) cost += innovation.cost();
    }
    return cost;
  }

  /// From the row before, which counts for `by`.
  void step_to(Filter<Dynamic, Form>& filter, std::size_t at, double by) const {
    if (at > 0 && !walk_.isZero(0.0)) {
      const double seconds = states::seconds_between(record_, rows_[at - 1].first, rows_[at].first);
      const MatrixXd same = MatrixXd::Identity(walk_.size(), walk_.size());
      filter.predict(
          Transition<Dynamic, Dynamic>{filter.x(), same, same, (seconds * walk_).asDiagonal()});
    }
    states::forget(filter, by);
  }

  /// Rows are residuals, whitened.
  Linearisation<Dynamic, Dynamic> expected(std::size_t at, const VectorXd& x) {
    const MatrixXd rows = samples_.rows(rows_[at], x, nullptr);
    return {-rows.rightCols<1>(), rows.leftCols(x.size())};
  }

  /// `before`: expected() at the estimate before the row.
  Innovation<Dynamic> absorb(Filter<Dynamic, Form>& filter, std::size_t at,
                             const Linearisation<Dynamic, Dynamic>& before) {
    const MatrixXd unit = MatrixXd::Identity(nothing_.size(), nothing_.size());
    if (options_.method != TrackMethod::iekf) {
      return filter.template update<Dynamic>(nothing_, before, unit);
    }
    return iterated_update<Dynamic, Form, Dynamic>(
        filter, nothing_, [&](const VectorXd& x) { return expected(at, x); }, unit,
        options_.iterations);
  }

  Samples& samples_;
  const Record& record_;
  const StreamStart& start_;
  const TrackOptions& options_;
  VectorXd nothing_;  // n_z zeros
  std::vector<std::string> names_;
  VectorXd walk_;  // variance a second
  states::ChangeWatch watch_;
  states::Forgetting forgetting_;
  std::vector<model::Measurements::Range> rows_;  // that the filter has seen, one each
};

/// Throws Error where outputs have a part that is no regressor's: what is differentiated has none.
void check_regressors_alone(Samples& samples, const model::Measurements::Range& range,
                            const MatrixXd& rows) {
  const Index n_z = samples.noise().size();
  for (Index j = 0; j < n_z; ++j) {
    const auto z = samples.measurements().output(static_cast<int>(j), range);
    for (std::size_t i = 0; i < range.rows; ++i) {
      const double left = rows(static_cast<Index>(i) * n_z + j, rows.cols() - 1);
      if (std::isnan(z[i]) || std::abs(left - z[i] / samples.noise()[j]) <= 1e-12 * std::abs(left))
        continue;
      throw OptionError({Option{"differentiate"},
                         " takes models of regressors alone, none of them held but at 0: no b"});
    }
  }
}

/// Transforms of all rows, those of the start among them.
void track_in_band(Samples& samples, const Record& record, const StreamStart& start,
                   const TrackOptions& options, Collected& collected) {
  const VectorXd x = start.xi(start.free);
  const Index n_z = samples.noise().size();
  const auto time = record.column("time");
  states::BandTrack filter(n_z, x, options);
  for (const auto& chunk : samples.measurements().chunks()) {
    for (const auto& range : chunk) {
      base::heed_stop();
      const MatrixXd rows = samples.rows(range, VectorXd::Zero(x.size()), nullptr);
      if (options.differentiate) check_regressors_alone(samples, range, rows);
      for (std::size_t i = 0; i < range.rows; ++i) {
        const MatrixXd sample = rows.middleRows(static_cast<Index>(i) * n_z, n_z);
        const VectorXd e = sample.rightCols<1>() - sample.leftCols(x.size()) * filter.solution();
        const bool is_used = filter.absorb(time[range.first + i], sample);
        if (range.offset + i < start.rows) continue;
        if (!is_used) ++collected.track().refused;
        collected.append(range.first + i, filter.solution(), filter.deviations(),
                         options.differentiate ? VectorXd(VectorXd::Constant(n_z, not_a_number))
                                               : VectorXd(e.cwiseProduct(samples.noise())));
      }
    }
  }
}

}  // namespace

std::vector<Variable> table_of(const Track& track, const BlockModel& model) {
  std::vector<Variable> known = model.tables().parameters();
  if (const auto* along = dynamic_cast<const StateBlockModel*>(&model)) {
    const auto& states = along->plan().model().states;
    known.insert(known.begin(), states.begin(), states.end());
    for (const Variable& noise : along->plan().model().noise) {
      known.emplace_back("q_" + noise.name, noise.unit);
    }
    for (const Variable& output : model.tables().outputs) {
      known.emplace_back("r_" + output.name, output.unit);
    }
  }
  std::vector<Variable> table;
  for (const std::string& name : track.names) {
    table.push_back(*std::ranges::find(known, name, &Variable::name));
  }
  return table;
}

FitOptions fit_of_start(const BlockModel& model, FitOptions fit, const TrackOptions& how) {
  if (!how.noise.empty()) fit.noise = how.noise;
  if (how.method != TrackMethod::rml && how.process_noise.empty()) return fit;
  fit.method = FitMethod::filter_error;
  fit.process_noise = how.process_noise;
  if (how.method == TrackMethod::rml) return fit;
  for (const Variable& noise : model.process_noises()) fit.process_noise.emplace(noise.name, 0.0);
  return fit;
}

Track track(const BlockModel& model, const Record& record, const StreamStart& start,
            const TrackOptions& options) {
  check_of_method(options);
  const auto* along = dynamic_cast<const StateBlockModel*>(&model);
  if (options.method == TrackMethod::rml) {
    if (along == nullptr) {
      throw Error("rml is for models with a state that noise drives; take rls, ekf, iekf or srif");
    }
    return states::track_likelihood(*along, record, start, options);
  }
  if (options.method == TrackMethod::rft) states::check_band_track(model, record, options);
  if (along != nullptr && options.method != TrackMethod::rls) {
    return states::track_jointly(*along, record, start, options);
  }
  if (along != nullptr) {
    check_linearised(options);
    check_trajectories(along->plan(), start);
  }
  check_start(model.tables(), start);
  if (is_filter(options.method) && model.new_carry() != nullptr) {
    throw Error("a model that carries a state of its own is tracked by rls, not by " +
                std::string(to_string(options.method)));
  }
  base::deviations_in_order({}, options.process_noise, "process noise");
  base::deviations_in_order({}, options.initial_states, "state");
  Samples samples(model, record, start, states::noise_of(model.tables().outputs, start, options));
  Collected collected(record, start, model.tables().n_z());
  if (options.method == TrackMethod::rft) {
    track_in_band(samples, record, start, options, collected);
  } else if (options.method == TrackMethod::rls) {
    track_linearised(samples, start, options, collected);
  } else if (options.method == TrackMethod::srif) {
    SampleStream<InformationForm<Dynamic>>(samples, record, start, options).run(collected);
  } else {
    SampleStream<SquareRootForm<Dynamic>>(samples, record, start, options).run(collected);
  }
  return std::move(collected.track());
}

}  // namespace sepcal
