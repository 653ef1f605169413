// SPDX-License-Identifier: BSD-3-Clause
// What is told of a fit's collinearity: the directions that the record hardly determines.
#pragma once

#include <vector>

#include "sepcal/collinearity.hpp"

namespace sepcal::estimation {

/// A condition index and the shares of its row, by estimate.
struct CollinearDirection {
  double condition_index = 0.0;
  std::vector<OutputValue> proportions;
};

/// Those whose index is above 10, the largest first.
std::vector<CollinearDirection> collinear_directions(const Collinearity& found);

}  // namespace sepcal::estimation
