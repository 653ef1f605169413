// SPDX-License-Identifier: BSD-3-Clause
// What model structure determination asks of a candidate, residuals taken for white: partial F, the
// orthogonal reduction of SSE, and the predicted square error (Klein & Morelli, Aircraft System
// Identification, 2006, 5.4; Barron 1984). Beside the verdict, which takes none of them.
#pragma once

#include <Eigen/Core>

#include "diagnosis/linearisation.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::diagnosis {

/// `residual`: count(), beyond the tangent. `reduction`: what q = `added` columns take of its sum
/// of squares, which is the square of the last column of T = [R q; 0 .] in their rows, once they
/// are appended to the tangent.
Structure measure_structure(const LinearisedFit& fit, const Eigen::VectorXd& residual,
                            double reduction, int added, PseBound bound);

}  // namespace sepcal::diagnosis
