// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/frequency/transform.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "numerics/order_statistics.hpp"

namespace sepcal {

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
