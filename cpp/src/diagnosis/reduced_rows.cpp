// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/reduced_rows.hpp"

#include <algorithm>

namespace sepcal::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;

ReducedRows::ReducedRows(const RowLayout& full, Index most, bool averaged)
    : stride((full.rows + most - 1) / most), average(averaged) {
  layout.outputs = full.outputs;
  for (const Segment& run : full.runs) {
    const auto first = static_cast<std::size_t>(layout.rows);
    layout.rows += (static_cast<Index>(run.rows()) + stride - 1) / stride;
    layout.runs.push_back({run.label, first, static_cast<std::size_t>(layout.rows)});
  }
}

MatrixXd ReducedRows::apply(const RowLayout& full, const Columns& columns) const {
  if (stride == 1) return columns.dense(full);
  MatrixXd reduced(layout.count(), columns.cols());
  Index at = 0;
  for (std::size_t j = 0; j < full.outputs.size(); ++j) {
    for (const Segment& run : full.runs) {
      for (std::size_t row = run.first; row < run.last; row += static_cast<std::size_t>(stride)) {
        const Index first = full.first(j) + static_cast<Index>(row);
        const Index count = std::min(stride, static_cast<Index>(run.last - row));
        reduced.row(at++) = average ? columns.rows(first, count).colwise().mean().eval()
                                    : columns.rows(first, 1).row(0).eval();
      }
    }
  }
  return reduced;
}

}  // namespace sepcal::diagnosis
