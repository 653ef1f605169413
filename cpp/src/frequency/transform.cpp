// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/frequency/transform.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/short_number.hpp"
#include "numerics/order_statistics.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using base::short_number;

namespace {

/// first, first + spacing ... first + steps spacing; fewer than none where the band holds none.
struct Steps {
  double first, spacing, steps;
};

Steps steps_of(const Band& band, double seconds) {
  constexpr double rounding = 1e-9;
  const double spacing = band.spacing > 0.0 ? band.spacing : 1.0 / seconds;
  const double first =
      band.spacing > 0.0 ? band.low : spacing * std::ceil(band.low / spacing - rounding);
  return {first, spacing, std::floor((band.high - first) / spacing + rounding)};
}

}  // namespace

void check_band(const Band& band) {
  const bool finite =
      std::isfinite(band.low) && std::isfinite(band.high) && std::isfinite(band.spacing);
  if (!finite || band.low <= 0.0 || band.high <= band.low) {
    throw Error("a band from " + short_number(band.low) + " to " + short_number(band.high) +
                " Hz is none; give a lower frequency above 0 and a higher one, as 0.1 and 2 Hz");
  }
  if (band.spacing < 0.0) {
    throw Error("frequencies can't be " + short_number(band.spacing) +
                " Hz apart; give a spacing above 0, or 0 for one over the length of the flight");
  }
}

std::vector<double> frequencies_of(const Band& band, double seconds) {
  check_band(band);
  constexpr double most = 1e5;
  const auto [first, spacing, steps] = steps_of(band, seconds);
  if (!(steps >= 1.0)) {
    throw Error("a band from " + short_number(band.low) + " to " + short_number(band.high) +
                " Hz holds less than two frequencies " + short_number(spacing) +
                " Hz apart, as a segment of " + short_number(seconds) +
                " s has them; widen the band or give a longer flight");
  }
  if (steps > most) {
    throw Error("a band from " + short_number(band.low) + " to " + short_number(band.high) +
                " Hz holds more than 100000 frequencies " + short_number(spacing) +
                " Hz apart; narrow the band, or give a wider spacing");
  }
  std::vector<double> frequencies;
  for (std::size_t k = 0; static_cast<double>(k) <= steps; ++k) {
    frequencies.push_back(first + static_cast<double>(k) * spacing);
  }
  return frequencies;
}

std::vector<std::vector<double>> frequencies_of(const Band& band,
                                                const std::vector<double>& seconds) {
  check_band(band);
  std::vector<std::vector<double>> all(seconds.size());
  const auto longest = std::ranges::max_element(seconds);
  for (std::size_t s = 0; s < seconds.size(); ++s) {
    const bool is_longest = seconds.begin() + static_cast<std::ptrdiff_t>(s) == longest;
    if (is_longest || steps_of(band, seconds[s]).steps >= 1.0) {
      all[s] = frequencies_of(band, seconds[s]);
    }
  }
  return all;
}

std::span<const double> time_of(const Record& record, const Segment& segment) {
  return record.column("time").subspan(segment.first, segment.rows());
}

double duration_of(std::span<const double> time) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < time.size(); ++k) steps.push_back(time[k] - time[k - 1]);
  if (steps.empty()) return 0.0;
  return time.back() - time.front() + numerics::select_quantile(steps, 0.5);
}

Eigen::MatrixXd without_line(const Eigen::MatrixXd& columns, std::span<const double> time) {
  const Eigen::Map<const Eigen::VectorXd> t(time.data(), columns.rows());
  Eigen::VectorXd slope = t.array() - t.mean();
  if (slope.squaredNorm() > 0.0) slope.normalize();
  Eigen::MatrixXd left = columns.rowwise() - columns.colwise().mean();
  left -= slope * (slope.transpose() * left).eval();
  return left;
}

Eigen::MatrixXcd fourier_transform(const Eigen::MatrixXd& columns, std::span<const double> time,
                                   std::span<const double> frequencies) {
  const Eigen::Index N = columns.rows();
  const auto count = static_cast<Eigen::Index>(frequencies.size());
  Eigen::MatrixXcd X = Eigen::MatrixXcd::Zero(count, columns.cols());
  if (N == 0) return X;
  const Eigen::Map<const Eigen::ArrayXd> t(time.data(), N);
  const Eigen::ArrayXd since = t - 0.5 * (t[0] + t[N - 1]);
  const double scale = std::sqrt(2.0 / static_cast<double>(N));
  for (Eigen::Index m = 0; m < count; ++m) {
    const Eigen::ArrayXd phase =
        2.0 * std::numbers::pi * frequencies[static_cast<std::size_t>(m)] * since;
    X.row(m).real() = scale * (phase.cos().matrix().transpose() * columns);
    X.row(m).imag() = -scale * (phase.sin().matrix().transpose() * columns);
  }
  return X;
}

Eigen::MatrixXcd without_ends(const Eigen::MatrixXcd& X, std::span<const double> time,
                              std::span<const double> frequencies) {
  const auto N = static_cast<Eigen::Index>(time.size());
  const Eigen::Index count = X.rows();
  const Eigen::Map<const Eigen::ArrayXd> t(time.data(), N);
  Eigen::MatrixXd line(N, 2);
  line << Eigen::VectorXd::Ones(N), (2.0 * t - t[0] - t[N - 1]) / std::max(t[N - 1] - t[0], 1e-300);
  const auto stack = [&](const Eigen::MatrixXcd& over) {
    Eigen::MatrixXd parts(2 * count, over.cols());
    parts << over.real(), over.imag();
    return parts;
  };
  Eigen::MatrixXd ends = stack(fourier_transform(line, time, frequencies));
  // Where frequencies are multiples of one over the rows' length, nothing is left of the constant.
  constexpr double nothing = 1e-9;
  if (ends.col(0).norm() <= nothing * ends.col(1).norm()) ends = Eigen::MatrixXd(ends.col(1));
  const Eigen::MatrixXd parts = stack(X);
  const Eigen::MatrixXd left = parts - ends * ends.householderQr().solve(parts);
  Eigen::MatrixXcd without(count, X.cols());
  without.real() = left.topRows(count);
  without.imag() = left.bottomRows(count);
  return without;
}

}  // namespace sepcal
