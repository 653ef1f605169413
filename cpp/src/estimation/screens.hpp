// SPDX-License-Identifier: BSD-3-Clause
// The paper's conditions on a sample of xi2 (Sun & Gebre-Egziabher, Eqs. 17 and 18), with A and b
// stacked over the record:
//   |dA/dxi2| l_2 / |A| <= T_1,  |db/dxi2| l_2 / |b| <= T_2,                            (Eq. 17)
//   sum_ij d2 A_ij / dxi2 dxi2' > 0,  sum_i d2 b_i / dxi2 dxi2' > 0.                    (Eq. 18)
// Norms are Frobenius': the root of the sum of squares of all entries, of the derivative over all
// parameters, too. By Cauchy and Schwarz |dA/dxi2| |dxi2| is then no less than |A|'s change to
// first order, and sums need but one row of the record at a time.
#pragma once

#include <Eigen/Core>

#include "base/thread_pool.hpp"
#include "estimation/problem.hpp"
#include "model/measurements.hpp"
#include "sepcal/detail/stage_one.hpp"

namespace sepcal::estimation {

/// Eqs. 17 and 18 at every column of `samples` (n_2 x S). Throws Error for a parameter without
/// bounds where l_2 is to follow from them.
ScreenResults screen(const Problem& problem, const Screens& screens,
                     const model::Measurements& measurements, const Eigen::MatrixXd& samples,
                     base::ThreadPool& pool);

/// Throws Error where every sample with a finite Tr[R] was rejected, with the thresholds that would
/// let one pass.
void check_some_accepted(const Screens& screens, const ScreenResults& results,
                         const Eigen::VectorXd& trace_r);

}  // namespace sepcal::estimation
