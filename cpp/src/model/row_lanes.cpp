// SPDX-License-Identifier: BSD-3-Clause
#include "model/row_lanes.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace sepcal::model {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

/// As a rule by one comparison of memory: all rows are as the first, and that is zero.
bool is_zero(const Eigen::Ref<const Eigen::VectorXd>& column) {
  if (column.size() == 0) return true;
  if (column[0] != 0.0) return false;
  const auto rest = static_cast<std::size_t>(column.size() - 1);
  if (std::memcmp(column.data(), column.data() + 1, rest * sizeof(double)) == 0) return true;
  return (column.array() == 0.0).all();  // of both signs
}

}  // namespace

RowLanes::RowLanes(int columns) : kit_(lanes::lane_kit()), beside_(columns) {}

bool RowLanes::fits(const Eigen::Ref<MatrixXd>& rows) const {
  return used_ &&
         std::ranges::all_of(left_out_, [&](Index column) { return is_zero(rows.col(column)); });
}

void RowLanes::begin_anew(const Eigen::Ref<MatrixXd>& rows) {
  beside_ = merge();
  kept_.clear();
  left_out_.clear();
  for (Index column = 0; column < rows.cols(); ++column) {
    (is_zero(rows.col(column)) ? left_out_ : kept_).push_back(column);
  }
  triangles_.assign(kept_.size() * kept_.size() * kit_.width, 0.0);
  used_ = true;
}

std::optional<lanes::Panel> RowLanes::take_rows(Eigen::Ref<MatrixXd> rows) {
  const std::size_t width = kit_.width;
  const auto stride = static_cast<std::size_t>(rows.outerStride());
  const std::size_t alignment = width * sizeof(double);
  const bool aligned = reinterpret_cast<std::uintptr_t>(rows.data()) % alignment == 0 &&  // NOLINT
                       stride % width == 0 && static_cast<std::size_t>(rows.rows()) % width == 0;
  if (!aligned) {
    beside_.absorb(rows);
    return {};
  }
  if (!fits(rows)) begin_anew(rows);
  if (kept_.empty()) return {};
  lanes::Panel panel{.T = triangles_.data(), .count = kept_.size()};
  for (std::size_t c = 0; c < kept_.size(); ++c) panel.columns[c] = rows.col(kept_[c]).data();
  return panel;
}

void RowLanes::absorb_outputs(std::span<RowLanes> outputs, Eigen::Ref<MatrixXd> rows) {
  const Index own = rows.rows() / static_cast<Index>(outputs.size());
  std::vector<lanes::Panel> panels;
  for (std::size_t j = 0; j < outputs.size(); ++j) {
    const auto panel = outputs[j].take_rows(rows.middleRows(static_cast<Index>(j) * own, own));
    if (panel) panels.push_back(*panel);
  }
  const lanes::LaneKit& kit = outputs.front().kit_;
  if (lanes::absorb_panels(kit, panels, static_cast<std::size_t>(own) / kit.width)) return;
  for (RowLanes& output : outputs) output.safe_ = false;  // whose rows are absorbed again together
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
