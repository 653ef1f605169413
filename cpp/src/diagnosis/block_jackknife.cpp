// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/block_jackknife.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/held_out.hpp"
#include "diagnosis/projection.hpp"
#include "numerics/tails.hpp"

namespace sepcal::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// So many that each is long beside what rows of the residual know of each other.
Index count_blocks(const RowLayout& layout, const VectorXd& residual) {
  constexpr double correlation_times = 4.0;
  constexpr double fewest = 6.0;
  constexpr double most = 40.0;
  const double wanted =
      static_cast<double>(layout.rows) / (correlation_times * correlation_rows(layout, residual));
  return static_cast<Index>(std::clamp(std::floor(wanted), fewest, most));
}

}  // namespace

double log10_block_tail(const NullHypothesis& null, MatrixXd columns) {
  const RowLayout& layout = null.fit().layout;
  // Not whitened: what a noise model takes for known it may know wrongly over a long time.
  const VectorXd beside = null.residual - columns * (columns.transpose() * null.residual);
  const Index blocks = count_blocks(layout, beside);
  null.whiten(columns);
  const MatrixXd B = orthonormal_basis(remove_span(null.white_basis, columns));
  const Index m = B.cols();
  if (m == 0) return 0.0;
  const VectorXd estimate = B.transpose() * null.white_residual;
  const VectorXd left = null.white_residual - B * estimate;

  MatrixXd covariance = MatrixXd::Zero(m, m);
  double leverage = 0.0;
  double squared = 0.0;
  for (Index b = 0; b < blocks; ++b) {
    const Index first = layout.rows * b / blocks;
    const Index count = layout.rows * (b + 1) / blocks - first;
    MatrixXd H = MatrixXd::Zero(m, m);
    VectorXd score = VectorXd::Zero(m);
    for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
      const auto rows = B.middleRows(layout.first(j) + first, count);
      H += rows.transpose() * rows;
      score += rows.transpose() * left.segment(layout.first(j) + first, count);
    }
    const VectorXd shift = (MatrixXd::Identity(m, m) - H).fullPivLu().solve(score);
    if (!shift.allFinite()) return 0.0;
    covariance += shift * shift.transpose();
    leverage += H.trace();
    squared += H.trace() * H.trace();
  }
  const double freedom = leverage * leverage / squared - 1.0;
  const Eigen::LDLT<MatrixXd> root(covariance);
  if (!(freedom >= 1.0) || root.info() != Eigen::Success || !root.isPositive()) return 0.0;
  const double wald = estimate.dot(root.solve(estimate));
  const auto k = static_cast<double>(m);
  if (!(wald > 0.0) || !(freedom > k - 1.0)) return 0.0;
  // Hotelling's: the covariance of m numbers is less well known than that of one.
  const double F = wald * (freedom - k + 1.0) / (k * freedom);
  return std::min(0.0, numerics::log10_f_tail(F, k, freedom - k + 1.0));
}

}  // namespace sepcal::diagnosis
