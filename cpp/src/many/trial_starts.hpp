// SPDX-License-Identifier: BSD-3-Clause
// Where trials of one design begin. A(xi2) of a sample is the same for all of them: factored once,
// it gives each trial's Tr[R] there (Sun & Gebre-Egziabher, Eqs. 16, 19) by products with z alone.
#pragma once

#include <Eigen/Core>

#include "base/thread_pool.hpp"
#include "many/trial_design.hpp"

namespace sepcal::many {

/// [xi1; xi2] of each trial (n x K): of `points` (n_2 x S) the one with the least Tr[R], xi1 by
/// linear least squares with R = I there. NaN where none is finite.
Eigen::MatrixXd find_starts(const TrialDesign& design, const Eigen::MatrixXd& points,
                            base::ThreadPool& pool);

}  // namespace sepcal::many
