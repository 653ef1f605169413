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

#include "base/aligned_doubles.hpp"
#include "model/lane_kit.hpp"
#include "model/measurements.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::model {

/// One factor of [A | z - b] over all outputs for each of many points.
class PointFactors {
 public:
  /// Triangles by tile, `width` to a tile, n x n as LaneFactor has them; whether each tile is
  /// right.
  PointFactors(base::AlignedDoubles triangles, std::vector<bool> clear, int columns,
               std::size_t width)
      : triangles_(std::move(triangles)), clear_(std::move(clear)), n_(columns), width_(width) {}

  /// None where lanes can't tell: a number that is not finite, a square that underflows, an entry
  /// of A that was taken for zero and is not.
  std::optional<TriangularFactor> factor(std::size_t point) const;

  /// What factor() has as remaining_square(); NaN where lanes can't tell, or where A is so near to
  /// singular that it takes more than a look at the diagonal.
  double remaining_square(std::size_t point) const;

 private:
  double entry(std::size_t point, int row, int column) const {
    const int place = (static_cast<int>(point / width_) * n_ + row) * n_ + column;
    return triangles_[static_cast<std::size_t>(place) * width_ + point % width_];
  }

  base::AlignedDoubles triangles_;
  std::vector<bool> clear_;
  int n_;
  std::size_t width_;
};

class PointLanes {
 public:
  /// Looks for zeros at some of the points. Both must outlive this.
  PointLanes(const BlockModel& model, const Measurements& measurements,
             const Eigen::MatrixXd& points);

  /// 0: the model has no lanes, or more columns than a factor in lanes takes.
  std::size_t width() const { return width_; }

  /// Of the points (n_2 x any number). `after_chunk` follows each of the measurements' chunks.
  PointFactors factor(const Eigen::MatrixXd& points,
                      const std::function<void()>& after_chunk) const;

 private:
  void find_zeros(const Eigen::MatrixXd& points);

  /// The factors of a tile's outputs, each of its own columns, as one of all columns, to `merged`.
  /// Returns whether every lane was safe.
  bool merge(const double* by_output, double* merged) const;

  const BlockModel& model_;
  const Measurements& measurements_;
  const lanes::LaneKit* kit_ = nullptr;
  std::size_t width_ = 0;
  std::vector<unsigned char> zero_;              // n_z x n_1
  std::vector<std::vector<Eigen::Index>> kept_;  // by output: columns of [A | z - b] of its factor
};

}  // namespace sepcal::model
