// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/filter_error_start.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/gaps.hpp"
#include "estimation/sampling.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double no_noise = -std::numeric_limits<double>::infinity();  // ln of no noise

/// Of one output's readings, one after the other: what white noise beside a slow signal would have.
struct Spread {
  double rms = 0.0;
  double rough = 0.0;     // standard deviation of white noise with these second differences
  double smallest = 0.0;  // difference that is not zero
};

Spread spread_of(const Record& record, std::span<const double> values) {
  Spread spread;
  double square = 0.0;
  double bends = 0.0;
  double count = 0.0;
  double triples = 0.0;
  spread.smallest = std::numeric_limits<double>::infinity();
  for (const Segment& segment : record.segments()) {
    std::size_t there = 0;
    double last = 0.0;
    double last_step = 0.0;
    for (const double value : values.subspan(segment.first, segment.rows())) {
      if (!std::isfinite(value)) continue;
      square += value * value;
      count += 1.0;
      const double step = value - last;
      if (there > 0 && step != 0.0) spread.smallest = std::min(spread.smallest, std::abs(step));
      if (there > 1) {
        bends += (step - last_step) * (step - last_step);
        triples += 1.0;
      }
      last = value;
      last_step = step;
      ++there;
    }
  }
  if (count > 0.0) spread.rms = std::sqrt(square / count);
  if (triples > 0.0) spread.rough = std::sqrt(bends / triples / 6.0);
  if (!std::isfinite(spread.smallest)) spread.smallest = 0.0;
  return spread;
}

class Start {
 public:
  Start(const BlockModel& model, const Record& record, const Problem& problem,
        const InnovationModel& innovations)
      : model_(model),
        record_(record),
        options_(problem.options()),
        innovations_(innovations),
        n_w_(innovations.noises()),
        n_z_(innovations.outputs()),
        n_(innovations.size() - n_w_ - n_z_) {
    for (const Variable& output : model.tables().outputs) {
      readings_.push_back(spread_of(record, record.column(output.name)));
    }
  }

  FilterErrorStart find() {
    FilterErrorStart start;
    start.cost_without = not_a_number;
    start.output_error = fit_output_error();
    if (start.output_error) {
      VectorXd theta(innovations_.size());
      theta.head(n_) = start.output_error->values();
      start.theta = choose_noise(theta, spreads_at(theta));
      start.cost_without = cost_without(theta);
    }
    // What runs away over the record is a poor fit of its parameters, or none.
    const bool poor = !start.output_error || !std::isfinite(start.cost_without) ||
                      start.output_error->status == FitStatus::not_converged;
    if (poor) {
      const VectorXd sampled = sample();
      const bool better =
          sampled.size() > 0 && (start.theta.size() == 0 || !(cost(start.theta) <= cost(sampled)));
      if (better) start.theta = sampled;
    }
    if (start.theta.size() == 0 || !std::isfinite(cost(start.theta))) {
      throw Error(
          "filter error found no point to begin at: the states can't be followed at any that was "
          "tried; narrow the bounds of the nonlinear parameters, or give starts");
    }
    start.floor = floor_at(start.theta);
    start.theta.tail(n_w_ + n_z_) = start.theta.tail(n_w_ + n_z_).cwiseMax(start.floor);
    hold_given(start.theta);
    silence(start.theta);
    return start;
  }

 private:
  double cost(const VectorXd& theta) const { return innovations_.value(theta).cost; }

  std::optional<Fit> fit_output_error() const {
    Record record = record_;  // it takes no missing readings
    for (const Variable& output : model_.tables().outputs) {
      const auto values = record.column(output.name);
      if (std::ranges::none_of(values, [](double z) { return std::isnan(z); })) continue;
      std::vector<double> filled(values.begin(), values.end());
      for (const Segment& segment : record.segments()) {
        base::bridge_gaps(std::span(filled).subspan(segment.first, segment.rows()));
      }
      record.replace(output.name, std::move(filled));
    }
    FitOptions options = options_;
    options.method = FitMethod::output_error;
    options.coloured_errors = false;
    options.process_noise.clear();
    options.stage_one_segments.clear();  // the record is what was selected
    options.stage_two_segments.clear();
    try {
      Fit fitted = fit(model_, record, options);
      if (!fitted.values().allFinite()) return {};
      return fitted;
    } catch (const Error&) {  // as where no trajectory stays finite
      return {};
    }
  }

  /// V_m without process noise, at the outputs' noise that makes it least.
  double cost_without(VectorXd theta) const {
    const std::vector<Spread> spreads = spreads_at(theta);
    theta.segment(n_, n_w_).setConstant(no_noise);
    for (Index j = 0; j < n_z_; ++j) {
      theta[n_ + n_w_ + j] = std::log(least(spreads[static_cast<std::size_t>(j)].rms, j));
    }
    hold_given_outputs(theta);
    return cost(theta);
  }

  /// Of the residual that is left without process noise.
  std::vector<Spread> spreads_at(VectorXd theta) const {
    theta.segment(n_, n_w_).setConstant(no_noise);
    theta.tail(n_z_).setZero();
    const MatrixXd e = innovations_.innovations(theta).e;
    std::vector<Spread> spreads;
    for (Index j = 0; j < n_z_; ++j) {
      spreads.push_back(spread_of(record_, {e.col(j).data(), static_cast<std::size_t>(e.rows())}));
    }
    return spreads;
  }

  /// A standard deviation of output j that is none of rounding.
  double least(double sd, Index j) const {
    constexpr double digits = 1e-12;
    const double size = readings_[static_cast<std::size_t>(j)].rms;
    return std::max(sd, digits * (size > 0.0 ? size : 1.0));
  }

  /// Sizes of the noises by V_m: shares of the residual that process noise may have made.
  VectorXd choose_noise(VectorXd theta, const std::vector<Spread>& spreads) const {
    VectorXd best;
    double lowest = std::numeric_limits<double>::infinity();
    const VectorXd unit = unit_at(theta, spreads);
    for (const double share : {1.0, 0.3, 0.1, 0.03, 0.01}) {
      for (const bool rough : {true, false}) {
        theta.segment(n_, n_w_) = (share * unit).array().log();
        for (Index j = 0; j < n_z_; ++j) {
          const Spread& spread = spreads[static_cast<std::size_t>(j)];
          const double sd = rough ? std::min(spread.rough, spread.rms) : spread.rms;
          theta[n_ + n_w_ + j] = std::log(least(sd, j));
        }
        hold_given(theta);
        const double here = cost(theta);
        if (!(here < lowest) && best.size() > 0) continue;
        lowest = here;
        best = theta;
      }
    }
    return best;
  }

  /// The process noises (n_w), each alone, that would leave such residuals.
  VectorXd unit_at(const VectorXd& theta, const std::vector<Spread>& spreads) const {
    const MatrixXd reach = innovations_.reach(theta);
    VectorXd unit = VectorXd::Constant(n_w_, std::numeric_limits<double>::infinity());
    for (Index k = 0; k < n_w_; ++k) {
      for (Index j = 0; j < n_z_; ++j) {
        if (!(reach(j, k) > 0.0)) continue;
        const double sd = least(spreads[static_cast<std::size_t>(j)].rms, j);
        unit[k] = std::min(unit[k], sd / reach(j, k));
      }
      if (!std::isfinite(unit[k])) unit[k] = 1.0;  // nothing shows it
    }
    return unit;
  }

  VectorXd floor_at(const VectorXd& theta) const {
    constexpr double share = 1e-3;    // of a process noise's unit: nothing, over any record
    constexpr double smaller = 1e-4;  // than where it began
    std::vector<Spread> spreads(static_cast<std::size_t>(n_z_));
    VectorXd floor(n_w_ + n_z_);
    for (Index j = 0; j < n_z_; ++j) {
      const double sd = std::exp(theta[n_ + n_w_ + j]);
      spreads[static_cast<std::size_t>(j)].rms = sd;
      const double resolution = readings_[static_cast<std::size_t>(j)].smallest / std::sqrt(12.0);
      floor[n_w_ + j] = std::log(std::min(sd, std::max(resolution, least(smaller * sd, j))));
    }
    floor.head(n_w_) = (share * unit_at(theta, spreads)).array().log();
    return floor;
  }

  void hold_given_outputs(VectorXd& theta) const {
    for (Index j = 0; j < n_z_; ++j) {
      const auto at =
          options_.noise.find(model_.tables().outputs[static_cast<std::size_t>(j)].name);
      if (at != options_.noise.end()) theta[n_ + n_w_ + j] = std::log(at->second);
    }
  }

  void hold_given(VectorXd& theta) const {
    hold_given_outputs(theta);
    const std::span<const Variable> noises = model_.process_noises();
    for (Index k = 0; k < n_w_; ++k) {
      const auto at = options_.process_noise.find(noises[static_cast<std::size_t>(k)].name);
      if (at != options_.process_noise.end()) theta[n_ + k] = std::log(at->second);
    }
  }

  /// Noises that reach no output, as those of states that are measured, are none.
  void silence(VectorXd& theta) const {
    const MatrixXd reach = innovations_.reach(theta);
    for (Index k = 0; k < n_w_; ++k) {
      if (!(reach.col(k).array() > 0.0).any()) theta[n_ + k] = no_noise;
    }
  }

  /// The best of samples of the nonlinear parameters, their linear ones solved by the filter, with
  /// three guesses of process noise; empty where there is none.
  VectorXd sample() const {
    const std::vector<Variable> all = model_.tables().parameters();
    const int n_1 = model_.tables().n_1();
    VectorXd theta = VectorXd::Zero(innovations_.size());
    std::vector<Variable> drawn;
    std::vector<Index> places;
    for (Index k = 0; k < n_; ++k) {
      const Variable& parameter = all[static_cast<std::size_t>(k)];
      const auto bounds = options_.bounds.find(parameter.name);
      const Interval box = bounds == options_.bounds.end()
                               ? Interval{parameter.lower, parameter.upper}
                               : bounds->second;
      const auto known = [&](const std::map<std::string, double>& values) {
        const auto at = values.find(parameter.name);
        if (at == values.end()) return false;
        theta[k] = at->second;
        return true;
      };
      if (known(options_.fix) || k < n_1) continue;
      if (known(options_.start) || known(options_.unsampled)) continue;
      const bool sampled = options_.sampling_distribution.contains(parameter.name) ||
                           (std::isfinite(box.lower) && std::isfinite(box.upper));
      if (!sampled) continue;  // from zero
      places.push_back(k);
      drawn.emplace_back(parameter.name, parameter.unit, box.lower, box.upper);
    }
    constexpr int most = 200;  // of a filter's passes each
    FitOptions drawing = options_;
    drawing.samples = places.empty() ? 1 : std::clamp(options_.samples, 1, most);
    const MatrixXd points = draw_samples(drawn, drawing);
    VectorXd best;
    double lowest = std::numeric_limits<double>::infinity();
    for (Index s = 0; s < points.cols(); ++s) {
      theta(places) = points.col(s);
      std::vector<Spread> rough(readings_);
      for (Spread& spread : rough) spread.rms = spread.rough;
      const VectorXd unit = unit_at(theta, rough);
      for (const double share : {0.1, 1.0, 10.0}) {
        VectorXd trial = theta;
        trial.segment(n_, n_w_) = (share * unit).array().log();
        for (Index j = 0; j < n_z_; ++j) {
          trial[n_ + n_w_ + j] = std::log(least(rough[static_cast<std::size_t>(j)].rms, j));
        }
        hold_given(trial);
        const double here = solve_linear(trial);
        if (!(here < lowest)) continue;
        lowest = here;
        best = trial;
      }
    }
    return best;
  }

  /// xi1 for the least V_m at the others, which it returns.
  double solve_linear(VectorXd& theta) const {
    const Eigen::Array<bool, Eigen::Dynamic, 1> moves = innovations_.moves();
    const std::vector<Variable> all = model_.tables().parameters();
    std::vector<Index> columns;  // among those that move no gains
    std::vector<Index> places;
    Index column = 0;
    for (Index k = 0; k < theta.size(); ++k) {
      if (moves[k]) continue;
      if (!options_.fix.contains(all[static_cast<std::size_t>(k)].name)) {
        columns.push_back(column);
        places.push_back(k);
      }
      ++column;
    }
    if (places.empty()) return cost(theta);
    columns.push_back(column);
    TriangularFactor factor(static_cast<int>(columns.size()));
    const InnovationModel::Value value =
        innovations_.linear_scores(theta, [&](std::size_t /*row*/, MatrixXd& rows) {
          MatrixXd chosen = rows(Eigen::all, columns);
          factor.absorb(chosen);
        });
    if (!std::isfinite(value.cost) || !factor.all_finite()) {
      return std::numeric_limits<double>::infinity();
    }
    const auto k = static_cast<Index>(places.size());
    const VectorXd q = factor.matrix().topRightCorner(k, 1);
    theta(places) += solve_triangular(factor.matrix().topLeftCorner(k, k), q).x;
    return cost(theta);
  }

  const BlockModel& model_;
  const Record& record_;
  const FitOptions& options_;
  const InnovationModel& innovations_;
  Index n_w_;
  Index n_z_;
  Index n_;
  std::vector<Spread> readings_;  // n_z
};

}  // namespace

FilterErrorStart start_filter_error(const BlockModel& model, const Record& record,
                                    const Problem& problem, const InnovationModel& innovations) {
  return Start(model, record, problem, innovations).find();
}

}  // namespace sepcal::estimation
