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

namespace sepcal::numerics {

inline constexpr Eigen::Index lane_count = 8;
using Lanes [[gnu::vector_size(lane_count * sizeof(double))]] = double;

inline void load(const double* from, Lanes& lanes) { std::memcpy(&lanes, from, sizeof lanes); }
inline void store(const Lanes& lanes, double* to) { std::memcpy(to, &lanes, sizeof lanes); }

/// Half as many, which fill a register of AVX2: for what is loaded and stored at every step, as
/// compilers take wider ones through memory there.
inline constexpr Eigen::Index quad_count = 4;
using Quad [[gnu::vector_size(quad_count * sizeof(double))]] = double;

inline void load(const double* from, Quad& quad) { std::memcpy(&quad, from, sizeof quad); }
inline void store(const Quad& quad, double* to) { std::memcpy(to, &quad, sizeof quad); }

inline double add_lanes(const Lanes& lanes) {
  using Half [[gnu::vector_size(lane_count / 2 * sizeof(double))]] = double;
  using Quarter [[gnu::vector_size(lane_count / 4 * sizeof(double))]] = double;
  const Half half = __builtin_shufflevector(lanes, lanes, 0, 1, 2, 3) +
                    __builtin_shufflevector(lanes, lanes, 4, 5, 6, 7);
  const Quarter quarter =
      __builtin_shufflevector(half, half, 0, 2) + __builtin_shufflevector(half, half, 1, 3);
  return quarter[0] + quarter[1];
}

}  // namespace sepcal::numerics
