// SPDX-License-Identifier: BSD-3-Clause
// Fewer rows than a layout has: means of rows that follow each other in a run, or some of them.
#pragma once

#include <Eigen/Core>

#include "diagnosis/columns.hpp"

namespace sepcal::diagnosis {

struct ReducedRows {
  RowLayout layout = {};
  Eigen::Index stride = 1;
  bool average = false;

  /// At most about `most` of the rows: means of `stride`, or one in `stride`.
  ReducedRows(const RowLayout& full, Eigen::Index most, bool averaged);

  /// Columns over the rows of `full`, which has the runs that these were made for.
  Eigen::MatrixXd apply(const RowLayout& full, const Columns& columns) const;
};

}  // namespace sepcal::diagnosis
