// SPDX-License-Identifier: BSD-3-Clause
// An output's factor of many rows, the rows dealt to lanes: each lane has a triangle of its own,
// and at the end these are merged. A column that is zero in every row costs nothing.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "base/aligned_doubles.hpp"
#include "model/lane_kit.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::model {

class RowLanes {
 public:
  /// Whether lanes take that many columns.
  static bool take(int columns) { return columns <= lanes::most_columns; }

  explicit RowLanes(int columns);

  /// As TriangularFactor::absorb(). Rows that are no whole number of lanes, or lie where registers
  /// don't load them, go to a factor beside the lanes.
  void absorb(const Eigen::Ref<Eigen::MatrixXd>& rows) { absorb_outputs({this, 1}, rows); }
  /// The same for several outputs at once, rows stacked output by output.
  static void absorb_outputs(std::span<RowLanes> outputs, Eigen::Ref<Eigen::MatrixXd> rows);

  /// False: a square has underflowed or overflowed, and the rows must be absorbed without lanes.
  bool is_safe() const { return safe_; }

  TriangularFactor merge() const;

 private:
  /// What of an output's rows goes to the lanes, of all columns that are kept; nothing where they
  /// went beside them, or where no column is.
  std::optional<lanes::Panel> take_rows(Eigen::Ref<Eigen::MatrixXd> rows);
  /// Whether every column that is left out is zero here, too.
  bool fits(const Eigen::Ref<Eigen::MatrixXd>& rows) const;
  /// Leaves out the columns that are zero, behind what lanes have seen so far.
  void begin_anew(const Eigen::Ref<Eigen::MatrixXd>& rows);

  const lanes::LaneKit& kit_;
  base::AlignedDoubles triangles_;  // of the columns that are kept
  std::vector<Eigen::Index> kept_;
  std::vector<Eigen::Index> left_out_;
  TriangularFactor beside_;
  bool used_ = false;
  bool safe_ = true;
};

}  // namespace sepcal::model
