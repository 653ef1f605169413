// SPDX-License-Identifier: BSD-3-Clause
// Recursions side by side, in the lanes of the widest registers that the processor has.
#pragma once

#include <Eigen/Core>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
/// A function whose loops are compiled for each width; the program takes one as it starts.
#define SEPCAL_EVERY_WIDTH \
  __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define SEPCAL_EVERY_WIDTH
#endif

namespace sepcal::noise {

inline constexpr Eigen::Index lane_count = 8;
using Lanes [[gnu::vector_size(lane_count * sizeof(double))]] = double;

inline void load(const double* from, Lanes& lanes) { std::memcpy(&lanes, from, sizeof lanes); }
inline void store(const Lanes& lanes, double* to) { std::memcpy(to, &lanes, sizeof lanes); }

}  // namespace sepcal::noise
