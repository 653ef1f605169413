// SPDX-License-Identifier: BSD-3-Clause
#include "model/row_lanes.hpp"

#include <cstdint>

namespace sepcal::model {

using Eigen::Index;
using Eigen::MatrixXd;

RowLanes::RowLanes(int columns)
    : kit_(lanes::lane_kit()),
      triangles_(static_cast<std::size_t>(columns * columns) * kit_.width, 0.0),
      beside_(columns) {}

void RowLanes::absorb(Eigen::Ref<MatrixXd> rows) {
  const std::size_t width = kit_.width;
  const auto stride = static_cast<std::size_t>(rows.outerStride());
  const auto count = static_cast<std::size_t>(rows.rows());
  const std::size_t alignment = width * sizeof(double);
  const bool aligned = reinterpret_cast<std::uintptr_t>(rows.data()) % alignment == 0 &&  // NOLINT
                       stride % width == 0 && count % width == 0;
  if (!aligned) {
    beside_.absorb(rows);
    return;
  }
  used_ = true;
  const auto absorb = kit_.absorb[static_cast<std::size_t>(rows.cols())];
  if (!absorb(triangles_.data(), rows.data(), count / width, stride)) safe_ = false;
}

TriangularFactor RowLanes::merge() const {
  TriangularFactor merged = beside_;
  if (!used_) return merged;
  const Index n = merged.columns();
  const auto width = static_cast<Index>(kit_.width);
  MatrixXd rows = MatrixXd::Zero(n * width, n);
  for (Index i = 0; i < n; ++i) {
    for (Index c = i; c < n; ++c) {
      for (Index lane = 0; lane < width; ++lane) {
        rows(i * width + lane, c) =
            triangles_[static_cast<std::size_t>((i * n + c) * width + lane)];
      }
    }
  }
  merged.absorb(rows);
  return merged;
}

}  // namespace sepcal::model
