// SPDX-License-Identifier: BSD-3-Clause
// What is compiled once for every instruction set: the kernels of the models that sepcal brings,
// and factors in lanes. One kit is chosen as the program starts.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "sepcal/detail/lane_kernel.hpp"

namespace sepcal::lanes {

inline constexpr int most_columns = 13;  // of a factor

enum class ShippedModel {
  attitude_independent,
  five_hole,
  magnetometer,
  pitot_static,
  scalar_1,
  scalar_2,
  vane_boom
};
inline constexpr std::size_t shipped_models = 7;

/// A factor T (n x n, upper; row i, column j in the lanes from (i * n + j) * width on) and rows
/// that join it, column c's row i in the lanes from columns[c] + i * width on, left destroyed.
struct Panel {
  double* T = nullptr;
  std::size_t count = 0;  // of columns, n
  std::array<double*, most_columns> columns{};
};

inline constexpr std::size_t most_panels = 3;  // in step

/// Each of `count` panels of m rows, most_panels at most: T becomes the factor of [T; rows].
/// Returns whether every lane was safe.
using AbsorbPanels = bool (*)(const Panel* panels, std::size_t count, std::size_t m);

struct LaneKit {
  const char* name;  // "avx2"
  std::size_t width;
  std::array<LaneKernel, shipped_models> models;
  std::array<AbsorbPanels, most_columns + 1> absorb;  // by columns
};

/// Columns of m rows one below the other, to join the factor T.
Panel stack_panel(const LaneKit& kit, std::size_t columns, double* T, double* rows, std::size_t m);

/// Absorbs any number of panels, those that follow each other with as many columns in step.
bool absorb_panels(const LaneKit& kit, std::span<const Panel> panels, std::size_t m);

/// The kit that SEPCAL_ISA names ("baseline", "avx2", "avx512"), else the widest that the processor
/// takes. Throws Error for a name that is unknown or that the processor can't run.
const LaneKit& lane_kit();

/// One of that many lanes which the processor takes; nullptr where there is none.
const LaneKit* lane_kit_of(std::size_t width);

}  // namespace sepcal::lanes
