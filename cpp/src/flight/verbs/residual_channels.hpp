// SPDX-License-Identifier: BSD-3-Clause
// Residuals against every channel of a flight: what a line and a smooth curve of it would explain.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/thread_pool.hpp"
#include "sepcal/flight/comparison.hpp"

namespace sepcal::verbs {

/// Every column of the record but the model's outputs, the labels, and what is constant or not
/// finite in the segments, against the outputs of these names. `residuals` (rows() x names) in the
/// record's order, finite.
/// Largest share_smooth first. Empty for fewer than 20 rows.
std::vector<ChannelMisfit> compare_channels(const Record& record, const Tables& tables,
                                            const std::vector<std::string>& names,
                                            const Eigen::MatrixXd& residuals,
                                            base::ThreadPool& pool);

}  // namespace sepcal::verbs
