// SPDX-License-Identifier: BSD-3-Clause
// The inputs of a composed model as its corrections leave them: first shifted and smoothed in time,
// then corrected sample by sample, each correction seeing what those before it left. Derivatives
// come along where they are asked for.
#pragma once

#include <Eigen/Core>
#include <map>
#include <span>
#include <vector>

#include "effects/composed_parts.hpp"
#include "numerics/interpolated_column.hpp"

namespace sepcal::effects {

/// An input over a block.
struct InputColumn {
  const double* values = nullptr;
  std::vector<double> own = {};  // what `values` points to where the input was changed
  Eigen::MatrixXd slopes = {};   // rows x directions; no columns: all zero
};

/// A node of the average over the past that a lag of the outputs is.
struct LagNode {
  double age = 0.0;     // in units of the lag
  double weight = 1.0;  // they sum to one
};

class InputCorrections {
 public:
  /// `parts` must outlive this; `record` is read now and no more.
  InputCorrections(const Tables& tables, const ComposedParts& parts, const Record& record);

  /// Whether inputs stay as they were logged.
  bool none() const { return parts_.corrections.empty() && parts_.delays.empty(); }

  /// Where in the past to evaluate; one node unless the outputs lag.
  std::span<const LagNode> nodes() const { return nodes_; }

  /// The inputs at xi2, with the derivatives with respect to the first `directions` of the
  /// nonlinear parameters: all of them, or 0 for none.
  std::vector<InputColumn> correct(const Block& block, const double* xi2, const LagNode& node,
                                   int directions) const;

  /// The inputs at xi2 without delays, with the derivatives with respect to the inputs as logged
  /// of the indices `moving`.
  std::vector<InputColumn> correct_moving(const Block& block, const double* xi2,
                                          std::span<const int> moving) const;

 private:
  struct Shift;

  Shift shift_of(int input, const double* xi2, const LagNode& node) const;
  double share_at(const DelayPart& part, std::size_t row) const;
  void shift_in_time(std::vector<InputColumn>& columns, const Block& block, const double* xi2,
                     const LagNode& node, int directions) const;
  void apply(const CorrectionPart& part, std::vector<InputColumn>& columns, const Block& block,
             const double* xi2, int directions, bool by_parameters) const;

  const ComposedParts& parts_;
  std::span<const LagNode> nodes_;
  std::map<int, numerics::InterpolatedColumn> interpolated_;  // by input
  std::vector<double> time_;                                  // where a clock drifts
};

}  // namespace sepcal::effects
