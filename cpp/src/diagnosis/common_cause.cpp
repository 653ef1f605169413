// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/common_cause.hpp"

#include <cmath>
#include <set>
#include <utility>

#include "base/stop.hpp"
#include "diagnosis/sign_flips.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_draws = 999;
constexpr int enough_as_strong = 20;  // then a probability is known well that is not small

/// Outputs of unit size, their rows no larger than two: the squares of a burst's few large rows
/// would be most of what its own products are held against.
MatrixXd limit_sizes(const MatrixXd& white) {
  constexpr double largest = 2.0;
  const auto rows = static_cast<double>(white.rows());
  MatrixXd limited = white;
  for (Index j = 0; j < white.cols(); ++j) {
    const double rms = std::sqrt(white.col(j).squaredNorm() / rows);
    limited.col(j) = (white.col(j) / rms).cwiseMax(-largest).cwiseMin(largest);
  }
  return limited;
}

using Pairs = std::vector<std::pair<Index, Index>>;

Pairs list_pairs(Index outputs) {
  Pairs pairs;
  for (Index j = 1; j < outputs; ++j) {
    for (Index k = 0; k < j; ++k) pairs.emplace_back(j, k);
  }
  return pairs;
}

/// Sums of products, of step and pair.
ArrayXXd sum_steps(const MatrixXd& x, const Pairs& pairs) {
  ArrayXXd sums(window_steps, static_cast<Index>(pairs.size()));
  for (Index step = 0; step < window_steps; ++step) {
    const Index first = row_of(step, x.rows());
    const Index rows = row_of(step + 1, x.rows()) - first;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto [j, k] = pairs[i];
      sums(step, static_cast<Index>(i)) =
          x.col(j).segment(first, rows).dot(x.col(k).segment(first, rows));
    }
  }
  return sums;
}

/// Correlations, windows x pairs; zero where there is nothing to correlate.
ArrayXXd correlate(const std::vector<Window>& windows, const ArrayXXd& products,
                   const ArrayXXd& squares) {
  ArrayXXd z(static_cast<Index>(windows.size()), products.cols());
  for (Index w = 0; w < z.rows(); ++w) {
    const Window& window = windows[static_cast<std::size_t>(w)];
    const Index length = window.last - window.first;
    const auto sum = products.middleRows(window.first, length).colwise().sum();
    const auto size = squares.middleRows(window.first, length).colwise().sum();
    z.row(w) = (size > 0.0).select(sum / size.sqrt(), 0.0);
  }
  return z;
}

/// The strongest pair, and what moves with one of the two.
std::vector<std::size_t> name_outputs(const Pairs& pairs, const Eigen::ArrayXd& z,
                                      Index strongest) {
  constexpr double belongs = 3.0;  // standard errors
  const auto [a, b] = pairs[static_cast<std::size_t>(strongest)];
  std::set<std::size_t> outputs;
  for (Index i = 0; i < z.size(); ++i) {
    const auto [j, k] = pairs[static_cast<std::size_t>(i)];
    const bool touches = j == a || j == b || k == a || k == b;
    if (i != strongest && !(touches && std::abs(z[i]) > belongs)) continue;
    outputs.insert({static_cast<std::size_t>(j), static_cast<std::size_t>(k)});
  }
  return {outputs.begin(), outputs.end()};
}

}  // namespace

CommonCause find_common_cause(const MatrixXd& white, std::uint64_t seed) {
  CommonCause cause;
  if (white.cols() < 2) return cause;
  const std::vector<Window> windows = nested_windows();
  const Pairs pairs = list_pairs(white.cols());
  MatrixXd x = limit_sizes(white);
  const ArrayXXd squares = sum_steps(x.cwiseAbs2(), pairs);
  const ArrayXXd z = correlate(windows, sum_steps(x, pairs), squares);
  Index window = 0;
  Index strongest = 0;
  const double most = z.abs().maxCoeff(&window, &strongest);
  cause.strongest = windows[static_cast<std::size_t>(window)];
  cause.outputs = name_outputs(pairs, z.row(window), strongest);
  const auto [a, b] = pairs[static_cast<std::size_t>(strongest)];
  const auto within = [&](Index column) {
    const Index first = row_of(cause.strongest.first, x.rows());
    return x.col(column).segment(first, row_of(cause.strongest.last, x.rows()) - first);
  };
  cause.share = std::abs(within(a).dot(within(b))) / (within(a).norm() * within(b).norm());
  cause.together = x.col(a) + std::copysign(1.0, z(window, strongest)) * x.col(b);
  std::mt19937_64 generator(seed);
  double draws = 1.0;  // the record is one of them
  double as_strong = 1.0;
  while (draws <= most_draws && as_strong <= enough_as_strong) {
    base::heed_stop();
    for (Index j = 0; j < x.cols(); ++j) flip_signs(x.col(j), generator);
    if (correlate(windows, sum_steps(x, pairs), squares).abs().maxCoeff() >= most) ++as_strong;
    ++draws;
  }
  cause.p_value = as_strong / draws;
  return cause;
}

}  // namespace sepcal::diagnosis
