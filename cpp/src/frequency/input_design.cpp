// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/frequency/input_design.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "base/short_number.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using base::short_number;
using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double turn = 2.0 * std::numbers::pi;

void check_amplitude(double amplitude) {
  if (amplitude > 0.0 && std::isfinite(amplitude)) return;
  throw Error("an amplitude of " + short_number(amplitude) +
              " is none; give the largest deflection, above 0");
}

void check_rate(double rate, const Band& band) {
  constexpr double fewest = 4.0;  // rows a period
  if (std::isfinite(rate) && rate >= fewest * band.high) return;
  throw Error(short_number(rate) + " rows a second are too few for " + short_number(band.high) +
              " Hz; give " + short_number(fewest * band.high) + " or more");
}

/// One input's sum of sines of unit amplitude over one period of unit length.
class Sum {
 public:
  /// `a_period`: points of the highest harmonic.
  explicit Sum(std::vector<int> harmonics, Index a_period = 48)
      : harmonics_(std::move(harmonics)), points_(a_period * harmonics_.back()) {}

  Index size() const { return static_cast<Index>(harmonics_.size()); }

  double angle(Index k, double at) const {
    return turn * static_cast<double>(harmonics_[static_cast<std::size_t>(k)]) * at;
  }

  double value(const VectorXd& phases, double at) const {
    double sum = 0.0;
    for (Index k = 0; k < size(); ++k) sum += std::sin(angle(k, at) + phases[k]);
    return sum;
  }

  /// At evenly spaced points, fine enough for the peaks between rows.
  ArrayXd values(const VectorXd& phases) const {
    ArrayXd u = ArrayXd::Zero(points_);
    for (Index k = 0; k < size(); ++k) u += wave(k, phases[k]).sin();
    return u;
  }

  /// d values / d phases, points x size.
  MatrixXd slopes(const VectorXd& phases) const {
    MatrixXd slopes(points_, size());
    for (Index k = 0; k < size(); ++k) slopes.col(k) = wave(k, phases[k]).cos();
    return slopes;
  }

  double peak_factor(const VectorXd& phases) const {
    const ArrayXd u = values(phases);
    const double rms = std::sqrt(0.5 * static_cast<double>(size()));
    return (u.maxCoeff() - u.minCoeff()) / (2.0 * std::numbers::sqrt2 * rms);
  }

 private:
  ArrayXd wave(Index k, double phase) const {
    const ArrayXd at = ArrayXd::LinSpaced(points_ + 1, 0.0, 1.0).head(points_);
    return turn * static_cast<double>(harmonics_[static_cast<std::size_t>(k)]) * at + phase;
  }

  std::vector<int> harmonics_;
  Index points_;
};

/// Schroeder 1970, of a level spectrum; another `rate` sweeps more slowly or faster.
VectorXd schroeder(Index count, double rate = 1.0) {
  VectorXd phases(count);
  for (Index k = 0; k < count; ++k) {
    phases[k] =
        -rate * std::numbers::pi * static_cast<double>(k * (k + 1)) / static_cast<double>(count);
  }
  return phases;
}

/// Phases of the least largest value, by norms of ever higher order (Guillaume et al. 1991): each
/// is a least-squares problem in the powers of the values, by Levenberg's and Marquardt's steps.
VectorXd flatten(const std::vector<int>& harmonics, VectorXd phases) {
  constexpr int steps = 20;
  const Sum sum(harmonics, 16);
  VectorXd best = phases;
  double least = sum.peak_factor(best);
  for (const double power : {2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0}) {
    double damping = 1e-3;
    for (int step = 0; step < steps && damping < 1e6; ++step) {
      const ArrayXd u = sum.values(phases);
      const double largest = u.abs().maxCoeff();
      const ArrayXd share = (u.abs() / largest).max(1e-12);
      const ArrayXd r = share.pow(power);
      const ArrayXd factor = power * share.pow(power - 1.0) * u.sign() / largest;
      const MatrixXd J = factor.matrix().asDiagonal() * sum.slopes(phases);
      MatrixXd H = J.transpose() * J;
      H.diagonal() += VectorXd::Constant(H.rows(), damping * H.diagonal().maxCoeff());
      const VectorXd next = phases - H.ldlt().solve(J.transpose() * r.matrix());
      const double cost = (sum.values(next).abs() / largest).pow(2.0 * power).sum();
      if (cost < r.square().sum()) {
        phases = next;
        damping *= 0.3;
        const double found = sum.peak_factor(phases);
        if (found < least) {
          least = found;
          best = phases;
        }
      } else {
        damping *= 5.0;
      }
    }
  }
  return best;
}

/// The best of several sweeps.
VectorXd flattest(const std::vector<int>& harmonics) {
  const Sum fine(harmonics);
  VectorXd best = schroeder(fine.size());
  for (const double rate : {1.0, 0.8, 1.25, 0.6, 1.6}) {
    VectorXd phases = flatten(harmonics, schroeder(fine.size(), rate));
    if (fine.peak_factor(phases) < fine.peak_factor(best)) best = std::move(phases);
  }
  return best;
}

/// Moves the period so that it begins where the sum rises through zero.
VectorXd begin_at_zero(const Sum& sum, const VectorXd& phases) {
  const ArrayXd u = sum.values(phases);
  const Index n = u.size();
  Index at = 0;
  while (at < n - 1 && !(u[at] <= 0.0 && u[at + 1] > 0.0)) ++at;
  double low = static_cast<double>(at) / static_cast<double>(n);
  double high = static_cast<double>(at + 1) / static_cast<double>(n);
  constexpr int halvings = 60;
  for (int i = 0; i < halvings; ++i) {
    const double middle = 0.5 * (low + high);
    (sum.value(phases, middle) > 0.0 ? high : low) = middle;
  }
  VectorXd moved(phases.size());
  for (Index k = 0; k < moved.size(); ++k) {
    moved[k] = std::remainder(phases[k] + sum.angle(k, 0.5 * (low + high)), turn);
  }
  return moved;
}

/// k / duration within the band, to the inputs in turn.
std::vector<std::vector<int>> deal(const MultisineOptions& options, std::size_t inputs) {
  constexpr double rounding = 1e-9;
  const int first = static_cast<int>(std::ceil(options.band.low * options.duration - rounding));
  const int last = static_cast<int>(std::floor(options.band.high * options.duration + rounding));
  std::vector<std::vector<int>> dealt(inputs);
  for (int k = std::max(first, 1); k <= last; ++k) {
    dealt[static_cast<std::size_t>(k - std::max(first, 1)) % inputs].push_back(k);
  }
  if (dealt.back().size() < 2) {
    throw Error("a band from " + short_number(options.band.low) + " to " +
                short_number(options.band.high) + " Hz has " +
                std::to_string(std::max(0, last - std::max(first, 1) + 1)) + " harmonics of " +
                short_number(options.duration) + " s, and " + std::to_string(inputs) +
                " inputs need two each; take longer, or a wider band");
  }
  return dealt;
}

void check_rows(double seconds, double rate) {
  constexpr double most = 2e5;
  if (seconds > 0.0 && seconds * rate <= most) return;
  throw Error(short_number(seconds) + " s of " + short_number(rate) +
              " rows a second can't be made; give times above 0 and at most 200000 rows");
}

/// Of 3-2-1-1 of unit amplitude, whose "1" lasts `step`: the square of its transform.
double energy_at(double frequency, double step) {
  constexpr std::array edges{0.0, 3.0, 5.0, 6.0, 7.0};
  const double w = turn * frequency;
  std::complex<double> sum = 0.0;
  double side = 1.0;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i, side = -side) {
    sum +=
        side * (std::polar(1.0, -w * edges[i] * step) - std::polar(1.0, -w * edges[i + 1] * step));
  }
  return std::norm(sum) / (w * w);
}

/// Parseval: the energy over all frequencies is the time that it isn't zero.
double share_in_band(const Band& band, double step) {
  constexpr int points = 400;
  double inside = 0.0;
  for (int i = 0; i < points; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / points;
    inside += energy_at(band.low + at * (band.high - band.low), step);
  }
  return 2.0 * inside * (band.high - band.low) / points / (7.0 * step);
}

}  // namespace

Multisines multisines(const std::vector<double>& amplitudes, const MultisineOptions& options) {
  check_band(options.band);
  if (amplitudes.empty()) throw Error("no input is named; give an amplitude for each");
  for (const double amplitude : amplitudes) check_amplitude(amplitude);
  check_rate(options.rate, options.band);
  check_rows(options.duration, options.rate);
  Multisines made;
  made.harmonics = deal(options, amplitudes.size());
  const auto rows = static_cast<Index>(std::lround(options.duration * options.rate)) + 1;
  for (Index row = 0; row < rows; ++row) {
    made.time.push_back(options.duration * static_cast<double>(row) /
                        static_cast<double>(rows - 1));
  }
  made.signals.resize(rows, static_cast<Index>(amplitudes.size()));
  for (std::size_t i = 0; i < amplitudes.size(); ++i) {
    const Sum sum(made.harmonics[i]);
    VectorXd phases = options.optimised ? flattest(made.harmonics[i]) : schroeder(sum.size());
    phases = begin_at_zero(sum, phases);
    const double scale = amplitudes[i] / sum.values(phases).abs().maxCoeff();
    for (Index row = 0; row < rows; ++row) {
      const double at = static_cast<double>(row) / static_cast<double>(rows - 1);
      made.signals(row, static_cast<Index>(i)) = scale * sum.value(phases, at);
    }
    made.signals(0, static_cast<Index>(i)) = 0.0;  // but for rounding
    made.signals(rows - 1, static_cast<Index>(i)) = 0.0;
    made.peak_factors.push_back(sum.peak_factor(phases));
    made.phases.emplace_back(phases.begin(), phases.end());
  }
  return made;
}

StepInput three_two_one_one(double amplitude, const StepsOptions& options) {
  check_band(options.band);
  check_amplitude(amplitude);
  check_rate(options.rate, options.band);
  if (!(options.before >= 0.0) || !(options.after >= 0.0)) {
    throw Error("rest before and after the steps is a time; give 0 or more");
  }
  // Steps from a tenth to twice the period of the middle frequency: beyond, less lies in the band.
  const double period = 1.0 / std::sqrt(options.band.low * options.band.high);
  constexpr int tries = 400;
  double best = 0.0;
  StepInput made;
  for (int i = 0; i <= tries; ++i) {
    const double step = period * 0.1 * std::pow(20.0, static_cast<double>(i) / tries);
    const double share = share_in_band(options.band, step);
    if (share > best) {
      best = share;
      made.step = step;
    }
  }
  const double rows = std::max(1.0, std::round(made.step * options.rate));
  made.step = rows / options.rate;
  made.share = share_in_band(options.band, made.step);
  const double seconds = options.before + 7.0 * made.step + options.after;
  check_rows(seconds, options.rate);
  const auto first = std::lround(options.before * options.rate);
  const auto count = static_cast<long>(rows);
  const auto last = first + 7 * count + std::lround(options.after * options.rate);
  for (long row = 0; row <= last; ++row) {
    const long ones = row < first ? -1 : (row - first) / count;
    double side = 0.0;
    if (ones >= 0 && ones < 7) side = ones < 3 || ones == 5 ? 1.0 : -1.0;
    made.time.push_back(static_cast<double>(row) / options.rate);
    made.signal.push_back(side * amplitude);
  }
  return made;
}

}  // namespace sepcal
