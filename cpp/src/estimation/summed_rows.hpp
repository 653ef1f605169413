// SPDX-License-Identifier: BSD-3-Clause
// Rows taken together. An estimate varies by the noise at the pace of its columns, and a likelihood
// of single rows speaks mostly of faster ones: of a long record's vibration, of what interpolation
// did between the answers of a slower sensor.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/record.hpp"

namespace sepcal::estimation {

/// Rows of a residual that count as one: 1 as a rule; more where it was held or interpolated, so
/// that its changes from row to row are zero or follow each other.
Eigen::Index find_held_rows(const Eigen::VectorXd& e, const std::vector<Segment>& runs);

/// Rows to take together: about `rows / 500`, but no more than leaves each of the columns X 97 % of
/// its square.
Eigen::Index find_slow_rows(const Eigen::MatrixXd& X, const std::vector<Segment>& runs);

/// Sums of `stride` rows that follow each other in a run (fewer at its end), over the root of their
/// number, and the runs of the sums. Columns that hardly change within a sum keep their products.
struct SummedRows {
  Eigen::MatrixXd columns;
  std::vector<Segment> runs;

  SummedRows(const Eigen::MatrixXd& rows, const std::vector<Segment>& of, Eigen::Index stride);
};

}  // namespace sepcal::estimation
