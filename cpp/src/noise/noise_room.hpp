// SPDX-License-Identifier: BSD-3-Clause
// What the parts of the noise model share: checks, and the blocks whose rows are stationary.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "noise/autoregression.hpp"
#include "sepcal/noise_model.hpp"

namespace sepcal::noise {

/// Throws Error unless d is in [0, 1), phi stationary and sigma finite and not negative.
void check_noise_model(const NoiseModel& model);

/// Rows of each segment. Throws Error for an empty one.
std::vector<Eigen::Index> find_lengths(const std::vector<Segment>& segments);

/// Rows of each segment with a distribution: one less where the level is free.
std::vector<Eigen::Index> find_blocks(std::vector<Eigen::Index> lengths, bool free_level);

/// The rows that have a distribution: e, or its differences within segments where the level is
/// free.
struct NoiseRows {
  NoiseRows(const Eigen::VectorXd& e, const std::vector<Eigen::Index>& lengths, bool level_is_free);

  bool free_level;
  std::vector<Eigen::Index> blocks;  // rows that follow each other
  Eigen::VectorXd values;            // block after block
};

}  // namespace sepcal::noise
