// SPDX-License-Identifier: BSD-3-Clause
#include "model/row_lanes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace sepcal::model {

using Eigen::Index;
using Eigen::MatrixXd;

RowLanes::RowLanes(int columns) : kit_(lanes::lane_kit()), beside_(columns) {}

bool RowLanes::fits(const Eigen::Ref<MatrixXd>& rows) const {
  return used_ && std::ranges::all_of(left_out_, [&](Index column) {
           return (rows.col(column).array() == 0.0).all();
         });
}

void RowLanes::begin_anew(const Eigen::Ref<MatrixXd>& rows) {
  beside_ = merge();
  kept_.clear();
  left_out_.clear();
  for (Index column = 0; column < rows.cols(); ++column) {
    ((rows.col(column).array() == 0.0).all() ? left_out_ : kept_).push_back(column);
  }
  triangles_.assign(kept_.size() * kept_.size() * kit_.width, 0.0);
  used_ = true;
}

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
  if (!fits(rows)) begin_anew(rows);
  if (kept_.empty()) return;
  std::array<double*, lanes::most_columns> columns{};
  for (std::size_t c = 0; c < kept_.size(); ++c) columns[c] = rows.col(kept_[c]).data();
  if (!kit_.absorb[kept_.size()](triangles_.data(), columns.data(), count / width)) safe_ = false;
}

TriangularFactor RowLanes::merge() const {
  TriangularFactor merged = beside_;
  if (!used_) return merged;
  const auto n = static_cast<Index>(kept_.size());
  const auto width = static_cast<Index>(kit_.width);
  MatrixXd rows = MatrixXd::Zero(n * width, merged.columns());
  for (Index i = 0; i < n; ++i) {
    for (Index c = i; c < n; ++c) {
      for (Index lane = 0; lane < width; ++lane) {
        rows(i * width + lane, kept_[static_cast<std::size_t>(c)]) =
            triangles_[static_cast<std::size_t>((i * n + c) * width + lane)];
      }
    }
  }
  merged.absorb(rows);
  return merged;
}

}  // namespace sepcal::model
