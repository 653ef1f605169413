// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/summed_rows.hpp"

#include <algorithm>
#include <cmath>

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The changes from row to row within runs.
std::vector<VectorXd> changes_of(const VectorXd& e, const std::vector<Segment>& runs) {
  std::vector<VectorXd> changes;
  for (const Segment& run : runs) {
    if (run.rows() < 2) continue;
    const auto first = static_cast<Index>(run.first);
    const auto count = static_cast<Index>(run.rows()) - 1;
    changes.emplace_back(e.segment(first + 1, count) - e.segment(first, count));
  }
  return changes;
}

/// Of changes that follow each other.
double correlation_of_changes(const VectorXd& e, const std::vector<Segment>& runs) {
  double product = 0.0;
  double square = 0.0;
  for (const VectorXd& change : changes_of(e, runs)) {
    const Index pairs = change.size() - 1;
    product += change.head(pairs).dot(change.tail(pairs));
    square += change.squaredNorm();
  }
  return square > 0.0 ? product / square : 0.0;
}

/// 1 unless most rows repeat the one before them: then the rows for each that doesn't.
double rows_a_jump(const VectorXd& e, const std::vector<Segment>& runs) {
  constexpr double small = 0.05;  // of the root mean square of all changes
  constexpr double most = 0.4;    // of the rows change: in white noise 96 %, in bursts 90 %
  double square = 0.0;
  Index count = 0;
  const std::vector<VectorXd> changes = changes_of(e, runs);
  for (const VectorXd& change : changes) {
    square += change.squaredNorm();
    count += change.size();
  }
  if (!(square > 0.0)) return 1.0;
  const double least = small * std::sqrt(square / static_cast<double>(count));
  Index jumps = 0;
  for (const VectorXd& change : changes) jumps += (change.array().abs() > least).count();
  const double share = static_cast<double>(jumps) / static_cast<double>(count);
  return share < most && jumps > 0 ? 1.0 / share : 1.0;
}

}  // namespace

Index find_held_rows(const VectorXd& e, const std::vector<Segment>& runs) {
  constexpr double follows = 0.2;  // a random walk's changes: 0; white noise's: -0.5
  constexpr Index fewest_sums = 40;
  const auto jump = static_cast<Index>(std::lround(rows_a_jump(e, runs)));
  Index stride = std::clamp<Index>(jump, 1, std::max<Index>(1, e.size() / fewest_sums));
  while (e.size() / (stride + 1) >= fewest_sums) {
    const SummedRows sums(e, runs, stride);
    if (correlation_of_changes(sums.columns, sums.runs) < follows) break;
    stride += (stride + 2) / 3;
  }
  return stride;
}

Index find_slow_rows(const MatrixXd& X, const std::vector<Segment>& runs) {
  constexpr Index enough = 500;
  constexpr double least = 0.97;
  const VectorXd squares = X.colwise().squaredNorm();
  for (Index stride = X.rows() / enough; stride > 1; stride = 2 * stride / 3) {
    const VectorXd left = SummedRows(X, runs, stride).columns.colwise().squaredNorm();
    if ((left.array() >= least * squares.array()).all()) return stride;
  }
  return 1;
}

SummedRows::SummedRows(const MatrixXd& rows, const std::vector<Segment>& of, Index stride) {
  Index count = 0;
  for (const Segment& run : of) {
    const auto first = static_cast<std::size_t>(count);
    count += (static_cast<Index>(run.rows()) + stride - 1) / stride;
    runs.push_back({run.label, first, static_cast<std::size_t>(count)});
  }
  columns.resize(count, rows.cols());
  Index at = 0;
  for (const Segment& run : of) {
    for (auto row = static_cast<Index>(run.first); row < static_cast<Index>(run.last);
         row += stride, ++at) {
      const Index taken = std::min(stride, static_cast<Index>(run.last) - row);
      columns.row(at) =
          rows.middleRows(row, taken).colwise().sum() / std::sqrt(static_cast<double>(taken));
    }
  }
}

}  // namespace sepcal::estimation
