// SPDX-License-Identifier: BSD-3-Clause
// Where scattered samples of a function suggest its minima: the samples are joined to their nearest
// neighbours and flooded from below. A basin is as deep as the water stands when it runs over into
// a lower one (0-dimensional persistence); scatter within one valley makes only shallow ones.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sepcal::numerics {

struct Basin {
  Eigen::Index lowest = 0;  // its lowest sample
  double depth = 0.0;       // up to the pass into a lower basin; infinite for the lowest of all
};

/// Deepest first. `points` is n x S, in coordinates of comparable length; `values` (S) may be
/// infinite where the function is not defined: such samples join nothing.
std::vector<Basin> find_basins(const Eigen::MatrixXd& points, const Eigen::VectorXd& values);

}  // namespace sepcal::numerics
