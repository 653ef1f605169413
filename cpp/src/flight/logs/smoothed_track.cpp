// SPDX-License-Identifier: BSD-3-Clause
#include "flight/logs/smoothed_track.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sepcal::logs {
namespace {

using Eigen::Matrix3d;
using Eigen::RowVector3d;
using Eigen::Vector3d;

constexpr std::size_t fewest = 3;  // fixes of a part

/// Position, velocity, acceleration, and their covariance in units of a fix's variance.
struct State {
  Vector3d x;
  Matrix3d P;
};

Matrix3d transition(double dt) {
  Matrix3d F;
  F << 1.0, dt, dt * dt / 2.0, 0.0, 1.0, dt, 0.0, 0.0, 1.0;
  return F;
}

/// Of white jerk of spectral density q.
Matrix3d jerk_noise(double dt, double q) {
  const double d2 = dt * dt;
  const double d3 = d2 * dt;
  Matrix3d Q;
  Q << d3 * d2 / 20.0, d2 * d2 / 8.0, d3 / 6.0,  //
      d2 * d2 / 8.0, d3 / 3.0, d2 / 2.0,         //
      d3 / 6.0, d2 / 2.0, dt;
  return q * Q;
}

/// What the filter says of one part.
struct Filtered {
  std::vector<State> predicted;
  std::vector<State> updated;
};

/// The innovations' share of the likelihood.
struct Innovations {
  double squares = 0.0;  // over their variances
  double logs = 0.0;     // of the variances
  std::size_t count = 0;
};

class Track {
 public:
  Track(std::span<const double> time, std::span<const double> position)
      : time_(time), position_(position), largest_(largest_variance(position)) {}

  /// Rows [first, last) with jerk of density q; the first fixes settle a state of which little is
  /// known, and count for nothing.
  Filtered filter(std::size_t first, std::size_t last, double q, Innovations& innovations) const {
    Filtered filtered;
    State state = begin(first);
    for (std::size_t i = first; i < last; ++i) {
      if (i > first) {
        const double dt = time_[i] - time_[i - 1];
        const Matrix3d F = transition(dt);
        state.x = F * state.x;
        state.P = F * state.P * F.transpose() + jerk_noise(dt, q);
      }
      filtered.predicted.push_back(state);
      const double variance = state.P(0, 0) + 1.0;
      const double innovation = position_[i] - state.x[0];
      const Vector3d gain = state.P.col(0) / variance;
      state.x += gain * innovation;
      // Joseph's form: what is unknown at first must not leave a negative variance behind.
      Matrix3d kept = Matrix3d::Identity();
      kept.col(0) -= gain;
      state.P = kept * state.P * kept.transpose() + gain * gain.transpose();
      filtered.updated.push_back(state);
      if (i < first + fewest) continue;
      innovations.squares += innovation * innovation / variance;
      innovations.logs += std::log(variance);
      ++innovations.count;
    }
    return filtered;
  }

  /// The part's smoothed states.
  std::vector<State> smooth(std::size_t first, std::size_t last, double q) const {
    Innovations unused;
    const Filtered filtered = filter(first, last, q, unused);
    std::vector<State> smoothed = filtered.updated;
    for (std::size_t i = smoothed.size() - 1; i-- > 0;) {
      const Matrix3d F = transition(time_[first + i + 1] - time_[first + i]);
      const State& ahead = filtered.predicted[i + 1];
      const Matrix3d gain = ahead.P.ldlt().solve(F * filtered.updated[i].P).transpose();
      smoothed[i].x += gain * (smoothed[i + 1].x - ahead.x);
      smoothed[i].P += gain * (smoothed[i + 1].P - ahead.P) * gain.transpose();
    }
    return smoothed;
  }

 private:
  /// A fix's variance can't be more: what is left of the positions by second differences, of which
  /// white noise has six times its variance.
  static double largest_variance(std::span<const double> position) {
    double sum = 0.0;
    for (std::size_t i = 2; i < position.size(); ++i) {
      const double bend = position[i] - 2.0 * position[i - 1] + position[i - 2];
      sum += bend * bend;
    }
    const auto count = static_cast<double>(std::max<std::size_t>(position.size(), 3) - 2);
    constexpr double least = 1e-8;  // m^2: positions that bend less have no noise
    return std::max(sum / (6.0 * count), least);
  }

  /// From two fixes, before the first: of the acceleration nothing is known but that it is less
  /// than some ten g.
  State begin(std::size_t first) const {
    constexpr double acceleration = 100.0;  // m/s^2
    const double dt = time_[first + 1] - time_[first];
    const double unknown = acceleration * acceleration / largest_;
    State state{Vector3d(position_[first], (position_[first + 1] - position_[first]) / dt, 0.0),
                Matrix3d::Zero()};
    state.P.diagonal() << 100.0, 100.0 * (2.0 / (dt * dt) + dt * dt / 4.0 * unknown), unknown;
    return state;
  }

  std::span<const double> time_;
  std::span<const double> position_;
  double largest_;  // m^2
};

Innovations innovations_of(const Track& track, const std::vector<std::size_t>& parts, double q) {
  Innovations innovations;
  for (std::size_t p = 0; p + 1 < parts.size(); ++p) {
    if (parts[p + 1] - parts[p] > fewest) track.filter(parts[p], parts[p + 1], q, innovations);
  }
  return innovations;
}

/// The jerk's density over a fix's variance that makes the fixes most likely: golden section on its
/// logarithm.
double find_density(const Track& track, const std::vector<std::size_t>& parts) {
  const auto cost = [&](double logarithm) {
    const Innovations seen = innovations_of(track, parts, std::exp(logarithm));
    const auto count = static_cast<double>(seen.count);
    constexpr double least = 1e-12;  // m^2
    if (!(count > 0.0)) return 0.0;
    return count * std::log(std::max(seen.squares / count, least)) + seen.logs;
  };
  constexpr double golden = 0.6180339887498949;
  double low = std::log(1e-9);
  double high = std::log(1e9);
  double inner_low = high - golden * (high - low);
  double inner_high = low + golden * (high - low);
  double cost_low = cost(inner_low);
  double cost_high = cost(inner_high);
  constexpr double close = 0.05;  // of a logarithm
  while (high - low > close) {
    if (cost_low < cost_high) {
      high = inner_high;
      inner_high = inner_low;
      cost_high = cost_low;
      inner_low = high - golden * (high - low);
      cost_low = cost(inner_low);
    } else {
      low = inner_low;
      inner_low = inner_high;
      cost_low = cost_high;
      inner_high = low + golden * (high - low);
      cost_high = cost(inner_high);
    }
  }
  return std::exp((low + high) / 2.0);
}

}  // namespace

SmoothedTrack smooth_track(std::span<const double> time, std::span<const double> position,
                           const std::vector<std::size_t>& parts) {
  constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
  SmoothedTrack smoothed;
  smoothed.position.assign(time.size(), nothing);
  smoothed.velocity.assign(time.size(), nothing);
  const Track track(time, position);
  const double q = find_density(track, parts);
  const Innovations seen = innovations_of(track, parts, q);
  const double variance = seen.count > 0 ? seen.squares / static_cast<double>(seen.count) : nothing;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t p = 0; p + 1 < parts.size(); ++p) {
    if (parts[p + 1] - parts[p] < fewest) continue;
    for (std::size_t i = parts[p]; const State& state : track.smooth(parts[p], parts[p + 1], q)) {
      smoothed.position[i] = state.x[0];
      smoothed.velocity[i] = state.x[1];
      sum += variance * state.P(1, 1);
      ++count;
      ++i;
    }
  }
  smoothed.position_error = std::sqrt(variance);
  smoothed.velocity_error = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : nothing;
  return smoothed;
}

}  // namespace sepcal::logs
