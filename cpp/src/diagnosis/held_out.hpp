// SPDX-License-Identifier: BSD-3-Clause
// Cross-validation of a candidate: every block of rows is predicted by what the others determine,
// with and without it. Both fits take one Gauss-Newton step from the fit to all rows, which is
// exact for linear terms.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/columns.hpp"

namespace sepcal::diagnosis {

/// Rows that are left out together, as a block; blocks of one fold are left out at once.
struct HeldOutBlock {
  Eigen::Index first = 0;  // among the N rows
  Eigen::Index last = 0;
  int fold = 0;
  bool judged = true;  // false: it would be extrapolated to
};

struct Folds {
  std::vector<HeldOutBlock> blocks;
  int count = 0;
  bool interleaved = false;
};

/// Runs of one label, each a fold of its own; no folds where there are fewer than four.
Folds whole_segments(const RowLayout& layout);

/// Blocks of at least ten correlation times [rows], at most sixty of them but `fewest` at least,
/// dealt to six folds.
Folds interleaved_blocks(const RowLayout& layout, double correlation_rows, int fewest);

/// Judges a block only where most of its rows lie, column by column of the candidate's G and output
/// by output, within what the other folds span.
void judge_interpolated(const RowLayout& layout, const Columns& G, Folds& folds);

/// The integrated correlation time of a residual [rows], of its most correlated output.
double correlation_rows(const RowLayout& layout, const Eigen::VectorXd& residual);

/// A third of the record at a time, in blocks in between, where each fold is two fits. `G`: the
/// candidate's columns.
Folds few_folds(const LinearisedFit& fit, const Columns& G);

struct HeldOut {
  double before = 0.0;  // RMSE over all outputs, in their unit, or in units of each one's own
  double after = 0.0;
  double gain = 0.0;    // 1 - after / before
  bool passed = false;  // mean gain of a block over its standard error > 1
  bool judged = false;  // false: too few blocks in which the driver interpolates
};

/// From the squared errors of each block without and with the candidate, over `measurements`.
HeldOut summarise(const std::vector<double>& before, const std::vector<double>& after,
                  double measurements);

/// `G`: the candidate's columns.
HeldOut hold_out(const LinearisedFit& fit, const Columns& G, const Folds& folds);

/// The same of two fits, without and with an effect, each by one step from itself: as good as real
/// fits to the other folds, where an effect bends the model too. `with`: of the same rows.
HeldOut hold_out(const LinearisedFit& without, const LinearisedFit& with, const Folds& folds);

/// RMSE over all outputs, in their unit, of a residual whose outputs are scaled; where they have
/// different units, in units of each one's own.
double total_rmse(const RowLayout& layout, const Eigen::VectorXd& residual);

}  // namespace sepcal::diagnosis
