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
#include "numerics/toeplitz.hpp"

namespace sepcal::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The autocorrelation of a column, of all outputs together, up to a quarter of the rows.
VectorXd autocorrelation(const RowLayout& layout, const Eigen::Ref<const VectorXd>& column) {
  VectorXd products = VectorXd::Zero(std::max<Index>(1, layout.rows / 4));  // by lag
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    for (const Segment& segment : layout.segments) {
      const auto rows = static_cast<Index>(segment.rows());
      const Index lags = std::min(products.size(), rows);
      const auto own = column.segment(layout.first(j) + static_cast<Index>(segment.first), rows);
      products.head(lags) += static_cast<double>(rows) * numerics::autocovariance(own, lags - 1);
    }
  }
  return products[0] > 0.0 ? VectorXd(products / products[0]) : VectorXd::Zero(products.size());
}

/// Over how many rows scores go together, the products of a column and the residual: no longer than
/// either does. A column that swings adds up nothing slow.
double rows_together(const RowLayout& layout, const MatrixXd& columns, const VectorXd& residual) {
  constexpr double negligible = 0.05;
  double longest = 1.0;
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    VectorXd own = VectorXd::Zero(residual.size());
    own.segment(layout.first(j), layout.rows) = residual.segment(layout.first(j), layout.rows);
    const VectorXd of_residual = autocorrelation(layout, own);
    for (const auto column : columns.colwise()) {
      const VectorXd of_column = autocorrelation(layout, column);
      double time = 1.0;
      for (Index lag = 1; lag < of_column.size(); ++lag) {
        if (of_column[lag] < negligible || of_residual[lag] < negligible) break;
        time += 2.0 * of_column[lag] * of_residual[lag];
      }
      longest = std::max(longest, time);
    }
  }
  return longest;
}

/// So many that each is long beside what rows of the scores know of each other.
Index count_blocks(Index rows, double memory) {
  constexpr double correlation_times = 4.0;
  constexpr double fewest = 6.0;
  constexpr double most = 40.0;
  const double wanted = static_cast<double>(rows) / (correlation_times * memory);
  return static_cast<Index>(std::clamp(std::floor(wanted), fewest, most));
}

}  // namespace

double log10_block_tail(const NullHypothesis& null, MatrixXd columns) {
  const RowLayout& layout = null.fit().layout;
  // Not whitened: what a noise model takes for known it may know wrongly over a long time.
  const VectorXd beside = null.residual - columns * (columns.transpose() * null.residual);
  null.whiten(columns);
  const MatrixXd B = orthonormal_basis(remove_span(null.white_basis, columns));
  const Index m = B.cols();
  if (m == 0) return 0.0;
  const double memory =
      null.fit().follows_path ? rows_together(layout, B, beside) : correlation_rows(layout, beside);
  const Index blocks = count_blocks(layout.rows, memory);
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
