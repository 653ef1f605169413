// SPDX-License-Identifier: BSD-3-Clause
// [A | z - b] of a whole record at many points of xi2, reduced to a triangular factor a point, the
// points side by side in the lanes of a register. An entry of A that is zero in every row costs
// nothing: each output has a factor of its own columns.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "model/lane_kit.hpp"
#include "model/measurements.hpp"
#include "sepcal/block_model.hpp"
#include "sepcal/triangular_factor.hpp"

namespace sepcal::model {

class PointLanes {
 public:
  /// Looks for zeros at some of the points. Both must outlive this.
  PointLanes(const BlockModel& model, const Measurements& measurements,
             const Eigen::MatrixXd& points);

  /// 0: the model has no lanes, or more columns than a factor in lanes takes.
  std::size_t width() const { return width_; }

  /// One factor of [A | z - b] over all outputs for each of the points (n_2 x any number). None
  /// where lanes can't tell: a number that is not finite, a square that underflows, an entry of A
  /// that was taken for zero and is not. `after_chunk` follows each of the measurements' chunks.
  std::vector<std::optional<TriangularFactor>> factor(
      const Eigen::MatrixXd& points, const std::function<void()>& after_chunk) const;

 private:
  void find_zeros(const Eigen::MatrixXd& points);

  const BlockModel& model_;
  const Measurements& measurements_;
  const lanes::LaneKit* kit_ = nullptr;
  std::size_t width_ = 0;
  std::vector<unsigned char> zero_;              // n_z x n_1
  std::vector<std::vector<Eigen::Index>> kept_;  // by output: columns of [A | z - b] of its factor
};

}  // namespace sepcal::model
