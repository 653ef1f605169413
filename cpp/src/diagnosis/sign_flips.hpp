// SPDX-License-Identifier: BSD-3-Clause
// Noise drawn from a record itself: the sizes stay in their rows, so that bursts stay bursts, and
// every sign is drawn anew.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

namespace sepcal::diagnosis {

/// Each sign by chance.
inline void flip_signs(Eigen::Ref<Eigen::VectorXd> values, std::mt19937_64& generator) {
  std::uint64_t bits = 0;
  for (Eigen::Index i = 0; i < values.size(); ++i, bits >>= 1U) {
    if (i % 64 == 0) bits = generator();
    if ((bits & 1U) != 0) values[i] = -values[i];
  }
}

}  // namespace sepcal::diagnosis
