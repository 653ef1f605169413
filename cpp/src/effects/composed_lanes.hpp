// SPDX-License-Identifier: BSD-3-Clause
// The rows of one block of a composed model at many points: the model's own tile, and beside each
// of its columns those that drivers make of it, the same at every point.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "base/aligned_doubles.hpp"
#include "effects/composed_parts.hpp"
#include "sepcal/detail/block_model.hpp"

namespace sepcal::effects {

class ComposedLanes {
 public:
  /// Everything must outlive this.
  ComposedLanes(const BlockModel& model, const Tables& tables, const ComposedParts& parts,
                const LaneBlock& block);

  /// As the model itself takes it.
  LaneBlock own_block() const;
  /// Values of a tile of the model's own.
  std::size_t own_size() const;

  /// A tile of the composed model, to `to`, from one of its model.
  void fill(const double* own, double* to) const;

 private:
  /// A column of the result: `base`, of the model's tile or 1, times a factor a row.
  struct Column {
    std::ptrdiff_t base = -1;         // among the columns of the model's tile; -1: 1
    std::vector<double> factor = {};  // rows; empty: 1 in each
  };

  void add_varying(Eigen::Index output, const std::vector<std::ptrdiff_t>& places);
  bool is_left_out(Eigen::Index output, Eigen::Index column) const;

  const BlockModel& model_;
  const Tables& tables_;
  const ComposedParts& parts_;
  const LaneBlock& block_;
  std::size_t width_;
  std::vector<const double*> inputs_;    // of the model
  std::vector<unsigned char> zero_;      // of the model
  std::vector<Eigen::MatrixXd> drives_;  // of each varying part, rows x functions
  std::vector<Column> columns_;          // in the result's order
};

}  // namespace sepcal::effects
