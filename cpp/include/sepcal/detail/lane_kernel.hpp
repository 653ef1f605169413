// SPDX-License-Identifier: BSD-3-Clause
// Stage one asks a model for the same rows at hundreds of points of xi2. A kernel evaluates several
// points side by side, each in a lane of the processor's registers; what depends on a row's u alone
// is computed once for all of them. Raw pointers alone: what is compiled for one instruction set
// must not exchange types with what is compiled for another.
#pragma once

#include <concepts>
#include <cstddef>

namespace sepcal {

/// Points of xi2, as many as lanes to a tile: tile t's k-th parameter stands in the `width` values
/// from (t * n_2 + k) * width on.
struct PointTiles {
  const double* xi2 = nullptr;
  std::size_t tiles = 0;
};

/// Rows one after another, few enough that a tile of them stays in the cache.
struct LaneBlock {
  const double* const* inputs = nullptr;   // n_u columns of `rows` values
  const double* const* outputs = nullptr;  // z, n_z columns
  std::size_t rows = 0;                    // most_lane_rows at most
  std::size_t first = 0;                   // the record's row at which the block begins
  /// n_z x n_1, 1: that entry of A is zero in every row of the record, and is left out.
  const unsigned char* zero = nullptr;
};

inline constexpr std::size_t most_lane_rows = 48;

/// Inputs that are differentiated at a time: an effect corrects few of a model's many.
inline constexpr int inputs_at_a_time = 4;

/// Called with a tile's [A | z - b]: output after output those columns that are not left out, one
/// below the other. A column's row i stands in the `width` values from i * width on.
using TileVisit = void (*)(void* visitor, std::size_t tile, double* rows);

/// The same rows for many trials, one in each lane, with parameters and measurements of its own: an
/// entry of a lane stands in the `width` values from its place times width on.
struct TrialRows {
  const void* prepared = nullptr;  // what prepare() made of the rows
  std::size_t rows = 0;
  const double* xi1 = nullptr;  // n_1 entries
  const double* xi2 = nullptr;  // n_2
  const double* z = nullptr;    // output j's row i is entry j * z_stride + i
  std::size_t z_stride = 0;
};

/// Consecutive rows, as many at a time as lanes.
struct LaneRows {
  const double* const* inputs = nullptr;  // n_u columns of `rows` values
  std::size_t rows = 0;
  const void* kept = nullptr;  // what LaneKernel::keep made of them, or nullptr
};

/// How one model is evaluated in lanes. `evaluate` returns whether all that was left out is zero;
/// `model` is what the kernel is for, `scratch`, aligned to 64 bytes, has room for a tile.
struct LaneKernel {
  std::size_t width = 0;
  bool (*evaluate)(const void* model, const LaneBlock& block, const PointTiles& points,
                   double* scratch, TileVisit visit, void* visitor) = nullptr;
  /// What BlockModel::evaluate() gives at one point, rows in the lanes: [A | b], or with xi1
  /// [A | D | b], column after column, `stride` values from one to the next.
  void (*fill_values)(const void* model, const LaneRows& rows, const double* xi2, double* to,
                      std::size_t stride) = nullptr;
  void (*fill_tangent)(const void* model, const LaneRows& rows, const double* xi2,
                       const double* xi1, double* to, std::size_t stride) = nullptr;
  /// What BlockModel::input_tangent() gives of `count` inputs, inputs_at_a_time at most; nullptr
  /// where the model isn't differentiated by its inputs.
  void (*fill_input_tangent)(const void* model, const LaneRows& rows, const double* xi2,
                             const double* xi1, const int* which, std::size_t count, double* to,
                             std::size_t stride) = nullptr;
  /// What of the rows depends on u alone, for passes to come, aligned to 64 bytes: so many bytes
  /// for every `width` rows, or fewer at the end; 0 of a model that tells of no such part.
  std::size_t kept_bytes = 0;
  void (*keep)(const void* model, const double* const* inputs, std::size_t rows,
               void* to) = nullptr;
  /// Bytes that `prepare` writes of a row, aligned to 64 at the first; 0: trials have no lanes.
  std::size_t prepared_bytes = 0;
  void (*prepare)(const void* model, const double* const* inputs, std::size_t rows,
                  void* to) = nullptr;
  /// [A | D | r] of every trial, r = z - A xi1 - b: output after output, column after column,
  /// `rows` entries each.
  void (*fill_trials)(const void* model, const TrialRows& trials, double* to) = nullptr;
};

/// A model M whose at() takes several numbers side by side, too, says `using LanesOf = M`: it
/// chooses between two values by where() and never by if, as one lane may need the one and its
/// neighbour the other (sepcal/detail/lanewise.hpp). What derives from it has no lanes, unless it
/// says so itself.
template <class M>
constexpr bool has_lanes() {
  if constexpr (requires { typename M::LanesOf; }) {
    return std::same_as<typename M::LanesOf, M>;
  }
  return false;
}

/// The kernel of a model that has lanes: of those that sepcal brings, the widest that the processor
/// takes; of another one, what its program is compiled for (sepcal/lanes.hpp makes it).
template <class M>
const LaneKernel& lane_kernel();

struct AttitudeIndependentMagnetometer;
struct FiveHoleProbe;
struct Magnetometer;
struct PitotStatic;
struct ScalarExample1;
struct ScalarExample2;
template <>
const LaneKernel& lane_kernel<AttitudeIndependentMagnetometer>();
template <>
const LaneKernel& lane_kernel<FiveHoleProbe>();
template <>
const LaneKernel& lane_kernel<Magnetometer>();
template <>
const LaneKernel& lane_kernel<PitotStatic>();
template <>
const LaneKernel& lane_kernel<ScalarExample1>();
template <>
const LaneKernel& lane_kernel<ScalarExample2>();

}  // namespace sepcal
