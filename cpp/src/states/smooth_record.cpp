// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/states/smooth_record.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <set>
#include <span>

#include "base/name_list.hpp"
#include "base/stop.hpp"
#include "sepcal/error.hpp"
#include "sepcal/states/filter.hpp"
#include "sepcal/states/smoother.hpp"
#include "states/known_inputs.hpp"
#include "states/start_deviations.hpp"

namespace sepcal {
namespace {

using Eigen::Dynamic;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<std::string> names_in(const std::vector<Variable>& table) {
  std::vector<std::string> names;
  for (const Variable& variable : table) names.push_back(variable.name);
  return names;
}

void check_deviation(const std::string& what, double sd) {
  if (sd > 0 && std::isfinite(sd)) return;
  throw Error(what + " must be a positive standard deviation");
}

void check_known(const std::map<std::string, double>& given, const std::vector<std::string>& known,
                 const std::string& what) {
  for (const auto& [name, sd] : given) {
    if (std::ranges::find(known, name) == known.end()) {
      throw Error("there is no " + what + " '" + name +
                  "'; the model has: " + base::list_names(known));
    }
    check_deviation("the " + what + " '" + name + "'", sd);
  }
}

/// Squares by name, in the order of the names; zero where not given.
VectorXd squares_of(const std::map<std::string, double>& given,
                    const std::vector<std::string>& names) {
  VectorXd squares = VectorXd::Zero(static_cast<Index>(names.size()));
  for (Index i = 0; i < squares.size(); ++i) {
    const auto at = given.find(names[static_cast<std::size_t>(i)]);
    if (at != given.end()) squares[i] = at->second * at->second;
  }
  return squares;
}

void check_noise(const SmoothingNoise& noise, const SmoothedRecord& names) {
  if (names.noises.empty()) {
    throw Error(
        "the model has no process noise, its table `noise` is empty; name there what "
        "drives its states");
  }
  if (noise.process.empty()) {
    throw Error(
        "no process noise is given, without which the fit's own trajectory is the smoothed "
        "one; give some of: " +
        base::list_names(names.noises));
  }
  check_known(noise.process, names.noises, "process noise");
  check_known(noise.outputs, names.outputs, "noise of an output");
  check_known(noise.start, names.states, "state");
  for (const std::string& output : names.outputs) {
    if (noise.outputs.contains(output)) continue;
    throw Error("the noise of output '" + output + "' is not given");
  }
}

VectorXd point_of(const Tables& tables, const std::map<std::string, double>& parameters) {
  const std::vector<Variable> all = tables.parameters();
  VectorXd xi(static_cast<Index>(all.size()));
  for (Index k = 0; k < xi.size(); ++k) {
    const auto at = parameters.find(all[static_cast<std::size_t>(k)].name);
    if (at == parameters.end()) {
      throw Error("parameter '" + all[static_cast<std::size_t>(k)].name +
                  "' has no value; smooth the record that was fitted");
    }
    xi[k] = at->second;
  }
  return xi;
}

/// Columns are the errors' axes, each as long as its standard deviation: the errors' covariance is
/// axes axes'. Taken of the correlations, as units differ.
MatrixXd axes_of(const MatrixXd& covariance) {
  const VectorXd sd = covariance.diagonal().cwiseSqrt();
  const MatrixXd correlation =
      sd.cwiseInverse().asDiagonal() * covariance * sd.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(correlation);
  const VectorXd lengths = parts.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  return sd.asDiagonal() * parts.eigenvectors() * lengths.asDiagonal();
}

/// The axes of the errors that act on a smoother, which are not an initial state's: a row for each
/// of the plan's parameters.
MatrixXd axes_on(const TrajectoryPlan& plan, const ParameterErrors& errors) {
  std::set<std::string> starts;
  for (const int i : plan.integrated()) {
    const std::string& state = plan.model().states[static_cast<std::size_t>(i)].name;
    for (int t = 0; t < plan.trajectories(); ++t) starts.insert(plan.start_name(state, t));
  }
  const std::vector<std::string> all = names_in(plan.tables().parameters());
  std::vector<Index> acting;
  std::vector<Index> rows;
  for (std::size_t k = 0; k < errors.names.size(); ++k) {
    if (starts.contains(errors.names[k])) continue;
    const auto at = std::ranges::find(all, errors.names[k]);
    if (at == all.end()) {
      throw Error("there is an error of '" + errors.names[k] +
                  "', which is no parameter of the model; it has: " + base::list_names(all));
    }
    acting.push_back(static_cast<Index>(k));
    rows.push_back(at - all.begin());
  }
  MatrixXd axes = MatrixXd::Zero(static_cast<Index>(all.size()), static_cast<Index>(acting.size()));
  if (!acting.empty()) axes(rows, Eigen::all) = axes_of(errors.covariance(acting, acting));
  return axes;
}

/// One record's smoothing; a segment at a time. What axes of the parameters' errors do to the
/// states goes along with them, to first order and with the gains as they are.
class Smoothing {
 public:
  Smoothing(const StateBlockModel& model, const Record& record, const VectorXd& xi,
            const SmoothingNoise& noise, MatrixXd axes, SmoothedRecord& result)
      : plan_(model.plan()),
        xi_(xi),
        noise_(noise),
        axes_(std::move(axes)),
        result_(result),
        density_(squares_of(noise.process, result.noises)),
        R_(squares_of(noise.outputs, result.outputs).asDiagonal()),
        steps_(model.steps(record, xi)),
        time_(record.column("time")) {
    for (const std::string& output : result.outputs) outputs_.push_back(record.column(output));
  }

  void run(const Segment& segment) {
    const VectorXd x = states::start_of(plan_, plan_.trajectory_at(segment.first, true), xi_);
    const VectorXd deviations =
        states::start_deviations(*steps_, segment, x, result_.states, noise_.start);
    const MatrixXd P = deviations.cwiseAbs2().asDiagonal();
    smooth(segment, filter(segment, Filter<Dynamic>(x, P)));
  }

 private:
  /// A row on the way: its stage, and what the axes do to x(k|k) and x(k+1|k).
  struct Passed {
    Stage<Dynamic, Dynamic> stage;
    MatrixXd filtered;   // n_x x axes
    MatrixXd predicted;  // n_x x axes
  };

  [[noreturn]] static void give_up(std::size_t row) {
    throw Error("the filter can't go on from row " + std::to_string(row) +
                " (counted from 0): the state or what is expected there is not finite; cut the "
                "segment, or start nearer");
  }

  std::vector<Passed> filter(const Segment& segment, Filter<Dynamic> filter) {
    std::vector<Passed> pass;
    pass.reserve(segment.rows());
    MatrixXd moved = MatrixXd::Zero(filter.x().size(), axes_.cols());
    for (std::size_t row = segment.first; row < segment.last; ++row) {
      base::heed_stop();
      update(row, filter, moved);
      pass.push_back({{filter.estimate()}, moved, moved});
      Transition<Dynamic, Dynamic>& next = pass.back().stage.next;
      const bool last = row + 1 == segment.last;
      const double held = plan_.discrete() || last ? 1.0 : time_[row + 1] - time_[row];
      next.Q_d = plan_.noise_variances(density_, held).asDiagonal();
      if (last) break;
      if (in_doubt()) {
        moved = pass.back().predicted =
            move(steps_->advance_jointly(row, filter.x(), density_).Phi, moved);
      }
      StateSteps::Step step = steps_->advance(row, filter.x());
      next = {std::move(step.x), std::move(step.Phi), std::move(step.Gamma), std::move(next.Q_d)};
      if (filter.predict(next) != FilterStatus::ok) give_up(row);
    }
    return pass;
  }

  void update(std::size_t row, Filter<Dynamic>& filter, MatrixXd& moved) {
    VectorXd y(static_cast<Index>(outputs_.size()));
    for (Index j = 0; j < y.size(); ++j) y[j] = outputs_[static_cast<std::size_t>(j)][row];
    const VectorXd x = filter.x();
    StateSteps::Reading expected = steps_->read(row, x);
    const MatrixXd H = expected.H;
    const auto innovation =
        filter.update<Dynamic>(y, {std::move(expected.z), std::move(expected.H)}, R_);
    if (innovation.status != FilterStatus::ok) give_up(row);
    result_.cost += innovation.cost();
    result_.readings += static_cast<std::size_t>(innovation.count);
    const MatrixXd Lambda = innovation.covariance();
    for (Index j = 0; j < y.size(); ++j) {
      if (std::isnan(y[j])) continue;
      result_.innovations(static_cast<Index>(row), j) = innovation.e[j];
      result_.innovation_sd(static_cast<Index>(row), j) = std::sqrt(Lambda(j, j));
    }
    if (!in_doubt()) return;
    // K = P(k|k) H' R^-1, of outputs that are there
    const VectorXd there = y.array().isNaN().select(0.0, R_.diagonal().cwiseInverse());
    const MatrixXd K = filter.covariance() * H.transpose() * there.asDiagonal();
    moved -= K * move(steps_->read_jointly(row, x).H, moved);
  }

  void smooth(const Segment& segment, const std::vector<Passed>& pass) {
    Smoothed<Dynamic, Dynamic> at = smooth_last(pass.back().stage);
    MatrixXd moved = pass.back().filtered;
    keep(segment.last - 1, at, moved, MatrixXd::Zero(at.w.size(), moved.cols()));
    for (std::size_t k = pass.size() - 1; k-- > 0;) {
      base::heed_stop();
      const auto& [stage, filtered, predicted] = pass[k];
      const auto gain = smoother_gain(stage);
      at = smooth_stage(stage, gain, at.x, at.P);
      const MatrixXd shift = gain.transposed.transpose() * (moved - predicted);
      moved = filtered + shift.topRows(at.x.size());
      keep(segment.first + k, at, moved, shift.bottomRows(at.w.size()));
    }
  }

  void keep(std::size_t row, const Smoothed<Dynamic, Dynamic>& smoothed, const MatrixXd& moved_x,
            const MatrixXd& moved_w) {
    const auto at = static_cast<Index>(row);
    result_.x.row(at) = smoothed.x.transpose();
    const Index n_w = density_.size();  // means; behind them stand slopes
    result_.w.row(at) = smoothed.w.head(n_w).transpose();
    result_.P[row] = smoothed.P + moved_x * moved_x.transpose();
    result_.Q[row] = smoothed.Q.topLeftCorner(n_w, n_w) +
                     moved_w.topRows(n_w) * moved_w.topRows(n_w).transpose();
  }

  bool in_doubt() const { return axes_.cols() > 0; }

  /// Slopes by x and xi times what the axes do to these.
  MatrixXd move(const MatrixXd& slopes, const MatrixXd& moved) const {
    return slopes.leftCols(moved.rows()) * moved + slopes.rightCols(axes_.rows()) * axes_;
  }

  const TrajectoryPlan& plan_;
  const VectorXd& xi_;
  const SmoothingNoise& noise_;
  MatrixXd axes_;  // a row for each of the plan's parameters
  SmoothedRecord& result_;
  VectorXd density_;
  MatrixXd R_;
  std::unique_ptr<StateSteps> steps_;
  std::span<const double> time_;
  std::vector<std::span<const double>> outputs_;
};

}  // namespace

ParameterErrors errors_of(const Fit& fit) {
  std::vector<Index> places;
  ParameterErrors errors;
  for (std::size_t k = 0; k < fit.parameters.size(); ++k) {
    const Parameter& parameter = fit.parameters[k];
    if (parameter.fixed || !(parameter.standard_error > 0.0)) continue;
    if (!std::isfinite(parameter.standard_error)) continue;
    places.push_back(static_cast<Index>(k));
    errors.names.push_back(parameter.name);
  }
  errors.covariance = fit.covariance(places, places);
  return errors;
}

SmoothedRecord smooth(const StateBlockModel& model, const Record& record,
                      const std::map<std::string, double>& parameters, const SmoothingNoise& noise,
                      const ParameterErrors& errors) {
  const TrajectoryPlan& plan = model.plan();
  SmoothedRecord result;
  for (const int i : plan.integrated()) {
    result.states.push_back(plan.model().states[static_cast<std::size_t>(i)].name);
  }
  result.noises = names_in(plan.model().noise);
  result.outputs = names_in(plan.tables().outputs);
  check_noise(noise, result);
  if (plan.options().scales_about_start) {
    throw Error("smooth() takes a scale times its output as it is; fit without scales_about_start");
  }
  states::check_inputs(model.tables(), record);
  const VectorXd xi = point_of(model.tables(), parameters);

  const auto rows = static_cast<Index>(record.length());
  const auto none = [rows](const std::vector<std::string>& names) {
    return MatrixXd::Constant(rows, static_cast<Index>(names.size()), not_a_number).eval();
  };
  result.x = none(result.states);
  result.w = none(result.noises);
  result.innovations = result.innovation_sd = none(result.outputs);
  const auto empty = [](const std::vector<std::string>& names) {
    const auto n = static_cast<Index>(names.size());
    return MatrixXd::Constant(n, n, not_a_number).eval();
  };
  result.P.assign(record.length(), empty(result.states));
  result.Q.assign(record.length(), empty(result.noises));
  Smoothing smoothing(model, record, xi, noise, axes_on(plan, errors), result);
  for (const Segment& segment : record.segments()) smoothing.run(segment);
  return result;
}

}  // namespace sepcal
