// SPDX-License-Identifier: BSD-3-Clause
// Whether an effect is told by stretches of the record that agree with each other, whatever the
// noise within a stretch and between outputs may be. Along a path noise is common to all outputs,
// and what no model of single outputs knows of it would pass for an effect.
#pragma once

#include <Eigen/Core>

#include "diagnosis/null_hypothesis.hpp"

namespace sepcal::diagnosis {

/// log10 of the probability that the effect of these columns (count() rows, orthonormal and beyond
/// the tangent) is none: Wald's test with the covariance of the delete-one-block jackknife, against
/// Fisher's F. Its degrees of freedom are those of the blocks that tell most, less one. Blocks are
/// of four correlation times of what is left, six to forty of them. 0 where a few blocks tell all.
double log10_block_tail(const NullHypothesis& null, Eigen::MatrixXd columns);

}  // namespace sepcal::diagnosis
