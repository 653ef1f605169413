// SPDX-License-Identifier: BSD-3-Clause
// What is compiled once for every instruction set: the kernels of the models that sepcal brings,
// and factors in lanes. One kit is chosen as the program starts.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "sepcal/lane_kernel.hpp"

namespace sepcal::lanes {

inline constexpr int most_columns = 13;  // of a factor

enum class ShippedModel {
  attitude_independent,
  five_hole,
  magnetometer,
  pitot_static,
  scalar_1,
  scalar_2
};
inline constexpr std::size_t shipped_models = 6;

struct LaneKit {
  const char* name;  // "avx2"
  std::size_t width;
  std::array<LaneKernel, shipped_models> models;
  /// By columns, as LaneFactor::absorb().
  std::array<bool (*)(double* T, double* const* columns, std::size_t m), most_columns + 1> absorb;
};

/// Absorbs a panel of m rows, its columns one below the other, behind the factor T.
bool absorb_panel(const LaneKit& kit, std::size_t columns, double* T, double* panel, std::size_t m);

/// The kit that SEPCAL_ISA names ("baseline", "avx2", "avx512"), else the widest that the processor
/// takes. Throws Error for a name that is unknown or that the processor can't run.
const LaneKit& lane_kit();

/// One of that many lanes which the processor takes; nullptr where there is none.
const LaneKit* lane_kit_of(std::size_t width);

}  // namespace sepcal::lanes
