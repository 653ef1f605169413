// SPDX-License-Identifier: BSD-3-Clause
#include "flight/aircraft/innovation_comparison.hpp"

#include <algorithm>
#include <cmath>

#include "estimation/theta_layout.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/states/smooth_record.hpp"

namespace sepcal::aircraft_log {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// w(k|N) over the root of its variance, which is that of w less Q(k|N): rows of the segments x
/// n_w. NaN where no reading tells it, as in a segment's last row.
MatrixXd scaled_disturbances(const SmoothedRecord& smoothed, const VectorXd& densities,
                             const TrajectoryPlan& plan, const Record& record) {
  constexpr double told = 1e-9;  // of the variance
  const auto time = record.column("time");
  const Index n_w = densities.size();
  MatrixXd scaled = MatrixXd::Constant(static_cast<Index>(record.rows()), n_w, not_a_number);
  Index at = 0;
  for (const Segment& segment : record.segments()) {
    for (std::size_t row = segment.first; row < segment.last; ++row, ++at) {
      if (row + 1 == segment.last) continue;
      const double duration = plan.discrete() ? 1.0 : time[row + 1] - time[row];
      for (Index k = 0; k < n_w; ++k) {
        const double variance = densities[k] / duration;
        const double known = variance - smoothed.Q[row](k, k);
        if (known > told * variance) {
          scaled(at, k) = smoothed.w(static_cast<Index>(row), k) / std::sqrt(known);
        }
      }
    }
  }
  return scaled;
}

/// The longest stretch of rows that follow each other beyond 3.
void find_stretch(Disturbance& disturbance, const VectorXd& scaled,
                  const std::vector<double>& time) {
  constexpr double far = 3.0;
  double beyond = 0.0;
  double told = 0.0;
  for (Index first = 0; first < scaled.size();) {
    if (!std::isnan(scaled[first])) told += 1.0;
    if (!(std::abs(scaled[first]) > far)) {
      ++first;
      continue;
    }
    Index last = first;
    double peak = 0.0;
    for (; last < scaled.size() && std::abs(scaled[last]) > far; ++last) {
      if (std::abs(scaled[last]) > std::abs(peak)) peak = scaled[last];
    }
    const auto rows = static_cast<std::size_t>(last - first);
    beyond += static_cast<double>(rows);
    told += static_cast<double>(rows) - 1.0;
    if (rows > disturbance.rows) {
      disturbance.rows = rows;
      disturbance.first_s = time[static_cast<std::size_t>(first)];
      disturbance.last_s = time[static_cast<std::size_t>(last - 1)];
      disturbance.peak = peak;
    }
    first = last;
  }
  if (told > 0.0) disturbance.share_beyond = beyond / told;
}

}  // namespace

FlightInnovations innovations_on(const LaidAircraft& laid, const Fit& at) {
  const InnovationModel::Innovations all =
      laid.model->innovations(readings_of(laid))->innovations(estimation::theta_of(at));
  const auto rows = static_cast<Index>(laid.record.rows());
  FlightInnovations chosen{MatrixXd(rows, all.e.cols()), MatrixXd(rows, all.e.cols())};
  Index row = 0;
  for (const Segment& segment : laid.record.segments()) {
    const auto first = static_cast<Index>(segment.first);
    const auto count = static_cast<Index>(segment.rows());
    chosen.e.middleRows(row, count) = all.e.middleRows(first, count);
    chosen.sd.middleRows(row, count) = all.sd.middleRows(first, count);
    row += count;
  }
  return chosen;
}

void judge_by_filter(Comparison& result, const FlightInnovations& innovations,
                     const AircraftFit& fitted, const Fit& at, const LaidAircraft& laid) {
  const std::vector<Variable>& outputs = laid.model->tables().outputs;
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    const auto column = static_cast<Index>(j);
    const Eigen::ArrayXd scaled =
        innovations.e.col(column).array() / innovations.sd.col(column).array();
    const auto there = scaled.isFinite();
    const double square = there.select(scaled.square(), 0.0).sum();
    result.sigma.push_back(
        {outputs[j].name, std::sqrt(square / static_cast<double>(there.count()))});
  }
  if (at.process_noise().empty()) {  // held at none: the states are the trajectory's own
    for (const NoiseSize& size : fitted.fit.noise_sizes) {
      if (size.name.starts_with("q_")) result.disturbances.push_back({.noise = size});
    }
    return;
  }
  const StateBlockModel& model = state_model_of(laid, fitted);
  SmoothingNoise noise{.process = at.process_noise()};
  for (const OutputValue& output : at.noise) noise.outputs[output.name] = output.value;
  constexpr double certain = 1e-9;  // the initial states are parameters
  for (const int i : model.plan().integrated()) {
    noise.start[model.plan().model().states[static_cast<std::size_t>(i)].name] = certain;
  }
  const SmoothedRecord smoothed = smooth(model, readings_of(laid), at.by_name(), noise);
  const std::span<const Variable> noises = model.process_noises();
  VectorXd densities = VectorXd::Zero(static_cast<Index>(noises.size()));
  for (std::size_t k = 0; k < noises.size(); ++k) {
    densities[static_cast<Index>(k)] = std::pow(at.noise_sizes[k].value, 2);
  }
  const MatrixXd scaled = scaled_disturbances(smoothed, densities, model.plan(), laid.record);
  for (std::size_t k = 0; k < noises.size(); ++k) {
    Disturbance disturbance{.noise = fitted.fit.noise_sizes[k]};
    if (!disturbance.noise.at_floor) {
      find_stretch(disturbance, scaled.col(static_cast<Index>(k)), result.time);
    }
    result.disturbances.push_back(disturbance);
  }
}

}  // namespace sepcal::aircraft_log
