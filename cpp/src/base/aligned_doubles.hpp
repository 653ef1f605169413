// SPDX-License-Identifier: BSD-3-Clause
// Doubles that registers of any width load and store.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sepcal::base {

using AlignedDoubles = std::vector<double, Eigen::aligned_allocator<double>>;

}  // namespace sepcal::base
