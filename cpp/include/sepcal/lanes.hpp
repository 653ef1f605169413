// SPDX-License-Identifier: BSD-3-Clause
// A model's kernel for the instruction set that a program is compiled for. Needs xsimd's headers;
// who fits a model of their own that has lanes includes this beside it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <bitset>
#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <xsimd/xsimd.hpp>

#include "sepcal/hoisted_model.hpp"
#include "sepcal/lane_angles.hpp"
#include "sepcal/lane_dual.hpp"
#include "sepcal/lane_kernel.hpp"
#include "sepcal/lanewise.hpp"
#include "sepcal/model.hpp"

namespace sepcal {

/// As many numbers as the instruction set `Arch` takes at once.
template <class Arch>
using Batch = xsimd::batch<double, Arch>;

template <class Arch>
struct Lanewise<xsimd::batch<double, Arch>> {
  using T = xsimd::batch<double, Arch>;
  static T where(const xsimd::batch_bool<double, Arch>& condition, const T& yes, const T& no) {
    return xsimd::select(condition, yes, no);
  }
  static std::pair<T, T> cos_sin(const T& x) { return lanes::cos_sin(x); }
  static bool vanishes(const T& x) { return xsimd::all(x == T(0.0)); }
};

}  // namespace sepcal

namespace Eigen {

template <class Arch>
struct NumTraits<xsimd::batch<double, Arch>> : sepcal::LaneTraits<1> {
  using Real = xsimd::batch<double, Arch>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = double;
};

template <class Arch, class Operation>
struct ScalarBinaryOpTraits<xsimd::batch<double, Arch>, double, Operation> {
  using ReturnType = xsimd::batch<double, Arch>;
};

template <class Arch, class Operation>
struct ScalarBinaryOpTraits<double, xsimd::batch<double, Arch>, Operation> {
  using ReturnType = xsimd::batch<double, Arch>;
};

}  // namespace Eigen

namespace sepcal::lanes {

// Kernels are flattened: a call to a model's part would pass its numbers through memory, and duals
// of batches are large; tangents take 1.3 (AVX-512) to 1.8 times (AVX2) as long with the calls.

/// A block's zero entries. A copy: a loop that stores what may be anything reads the block's own
/// again for each row.
template <int entries>
using ZeroEntries = std::bitset<static_cast<std::size_t>(entries)>;

template <int entries>
ZeroEntries<entries> find_zero_entries(const LaneBlock& block) {
  ZeroEntries<entries> zero;
  for (std::size_t k = 0; block.zero != nullptr && k < zero.size(); ++k) {
    zero[k] = block.zero[k] != 0;
  }
  return zero;
}

/// As LaneKernel::evaluate.
template <class Arch, class M>
[[gnu::flatten]] bool evaluate_points(const void* of_model, const LaneBlock& block,
                                      const PointTiles& points, double* scratch, TileVisit visit,
                                      void* visitor) {
  constexpr std::size_t width = Batch<Arch>::size;
  constexpr int n_u = Sizes<M>::n_u;
  constexpr int n_z = Sizes<M>::n_z;
  constexpr int n_1 = Sizes<M>::n_1;
  constexpr int n_2 = Sizes<M>::n_2;
  const M& model = *static_cast<const M*>(of_model);
  decltype(hoisting::prepare(model, Vec<double, n_u>())) prepared[most_lane_rows];
  for (std::size_t i = 0; i < block.rows; ++i) {
    Vec<double, n_u> u;
    for (int k = 0; k < n_u; ++k) u[k] = block.inputs[k][i];
    prepared[i] = hoisting::prepare(model, u);
  }
  const ZeroEntries<n_z * n_1> left_out = find_zero_entries<n_z * n_1>(block);
  xsimd::batch_bool<double, Arch> left_out_holds(true);  // of a zero; NaN is none
  const std::size_t stride = block.rows * width;
  for (std::size_t t = 0; t < points.tiles; ++t) {
    Vec<Batch<Arch>, n_2> xi2;
    for (int k = 0; k < n_2; ++k) {
      const std::size_t at = (t * n_2 + static_cast<std::size_t>(k)) * width;
      xi2[k] = Batch<Arch>::load_unaligned(points.xi2 + at);
    }
    const auto settled = hoisting::settle(model, xi2);
    for (std::size_t i = 0; i < block.rows; ++i) {
      const auto z = hoisting::combine(model, prepared[i], settled);
      double* to = scratch + i * width;
      for (int j = 0; j < n_z; ++j) {
        for (int c = 0; c < n_1; ++c) {
          if (left_out[static_cast<std::size_t>(j) * n_1 + static_cast<std::size_t>(c)]) {
            left_out_holds = left_out_holds && z.A(j, c) == Batch<Arch>(0.0);
          } else {
            z.A(j, c).store_aligned(to);
            to += stride;
          }
        }
        (Batch<Arch>(block.outputs[j][i]) - z.b[j]).store_aligned(to);
        to += stride;
      }
    }
    visit(visitor, t, scratch);
  }
  return xsimd::all(left_out_holds);
}

/// The inputs of the `count` rows from `row` on, no more than lanes; the last one fills up the
/// rest.
template <class Arch, int n_u>
Vec<Batch<Arch>, n_u> load_rows(const double* const* inputs, std::size_t row, std::size_t count) {
  constexpr std::size_t width = Batch<Arch>::size;
  Vec<Batch<Arch>, n_u> u;
  for (int k = 0; k < n_u; ++k) {
    if (count == width) {
      u[k] = Batch<Arch>::load_unaligned(inputs[k] + row);
      continue;
    }
    alignas(Arch::alignment()) double padded[width];
    for (std::size_t i = 0; i < width; ++i) {
      padded[i] = inputs[k][row + (i < count ? i : count - 1)];
    }
    u[k] = Batch<Arch>::load_aligned(padded);
  }
  return u;
}

template <class Arch>
void store_rows(const Batch<Arch>& values, std::size_t count, double* to) {
  constexpr std::size_t width = Batch<Arch>::size;
  if (count == width) {
    values.store_unaligned(to);
    return;
  }
  alignas(Arch::alignment()) double all[width];
  values.store_aligned(all);
  for (std::size_t i = 0; i < count; ++i) to[i] = all[i];
}

/// n numbers, each in every lane.
template <class Arch, int n>
Vec<Batch<Arch>, n> same_in_all(const double* values) {
  Vec<Batch<Arch>, n> x;
  for (int k = 0; k < n; ++k) x[k] = Batch<Arch>(values[k]);
  return x;
}

/// As LaneKernel::fill_values.
template <class Arch, class M>
[[gnu::flatten]] void fill_values(const void* of_model, const double* const* inputs,
                                  std::size_t rows, const double* xi2, double* to,
                                  std::size_t stride) {
  constexpr std::size_t width = Batch<Arch>::size;
  constexpr int n_z = Sizes<M>::n_z;
  constexpr int n_1 = Sizes<M>::n_1;
  const M& model = *static_cast<const M*>(of_model);
  const auto settled = hoisting::settle(model, same_in_all<Arch, Sizes<M>::n_2>(xi2));
  for (std::size_t row = 0; row < rows; row += width) {
    const std::size_t count = std::min(width, rows - row);
    const auto z = hoisting::combine(
        model, hoisting::prepare(model, load_rows<Arch, Sizes<M>::n_u>(inputs, row, count)),
        settled);
    for (int j = 0; j < n_z; ++j) {
      double* const own = to + static_cast<std::size_t>(j) * rows + row;
      for (int c = 0; c < n_1; ++c) {
        store_rows<Arch>(z.A(j, c), count, own + static_cast<std::size_t>(c) * stride);
      }
      store_rows<Arch>(z.b[j], count, own + n_1 * stride);
    }
  }
}

/// The tangent of any row at one point: by hand where the model has it so, else by dual numbers.
template <class Arch, class M>
class TangentAt {
  using B = Batch<Arch>;
  static constexpr int n_z = Sizes<M>::n_z;
  static constexpr int n_1 = Sizes<M>::n_1;
  static constexpr int n_2 = Sizes<M>::n_2;

 public:
  TangentAt(const M& model, const Vec<B, n_1>& xi1, const Vec<B, n_2>& xi2)
      : model_(model), xi1_(xi1), settled_(settle(model, xi2)) {}

  template <class Row>
  Tangent<B, n_z, n_1, n_2> of(const Row& prepared) const {
    if constexpr (HasTangent<M>) {
      return model_.tangent(prepared, settled_, xi1_);
    } else {
      const auto z = hoisting::combine(model_, prepared, settled_);
      Tangent<B, n_z, n_1, n_2> tangent;
      for (int j = 0; j < n_z; ++j) {
        tangent.z.b[j] = z.b[j].a;
        auto slopes = z.b[j].v;
        for (int c = 0; c < n_1; ++c) {
          tangent.z.A(j, c) = z.A(j, c).a;
          for (std::size_t i = 0; i < slopes.size(); ++i) {
            slopes[i] = xsimd::fma(xi1_[c], z.A(j, c).v[i], slopes[i]);
          }
        }
        for (int i = 0; i < n_2; ++i) tangent.D(j, i) = slopes[static_cast<std::size_t>(i)];
      }
      return tangent;
    }
  }

 private:
  static auto settle(const M& model, const Vec<B, n_2>& xi2) {
    if constexpr (HasTangent<M>) {
      return hoisting::settle(model, xi2);
    } else {
      Vec<LaneDual<Arch, n_2>, n_2> x;
      for (int k = 0; k < n_2; ++k) x[k] = LaneDual<Arch, n_2>(xi2[k], k);
      return hoisting::settle(model, x);
    }
  }

  const M& model_;
  Vec<B, n_1> xi1_;
  decltype(settle(std::declval<const M&>(), Vec<B, n_2>())) settled_;
};

/// As LaneKernel::fill_tangent.
template <class Arch, class M>
[[gnu::flatten]] void fill_tangent(const void* of_model, const double* const* inputs,
                                   std::size_t rows, const double* xi2, const double* xi1,
                                   double* to, std::size_t stride) {
  constexpr std::size_t width = Batch<Arch>::size;
  constexpr int n_z = Sizes<M>::n_z;
  constexpr int n_1 = Sizes<M>::n_1;
  constexpr int n_2 = Sizes<M>::n_2;
  const M& model = *static_cast<const M*>(of_model);
  const TangentAt<Arch, M> tangent(model, same_in_all<Arch, n_1>(xi1), same_in_all<Arch, n_2>(xi2));
  for (std::size_t row = 0; row < rows; row += width) {
    const std::size_t count = std::min(width, rows - row);
    const auto [z, D] =
        tangent.of(hoisting::prepare(model, load_rows<Arch, Sizes<M>::n_u>(inputs, row, count)));
    for (int j = 0; j < n_z; ++j) {
      double* own = to + static_cast<std::size_t>(j) * rows + row;
      for (int c = 0; c < n_1; ++c, own += stride) store_rows<Arch>(z.A(j, c), count, own);
      for (int i = 0; i < n_2; ++i, own += stride) store_rows<Arch>(D(j, i), count, own);
      store_rows<Arch>(z.b[j], count, own);
    }
  }
}

/// As LaneKernel::fill_input_tangent.
template <class Arch, class M>
[[gnu::flatten]] void fill_input_tangent(const void* of_model, const double* const* inputs,
                                         std::size_t rows, const double* xi2, const double* xi1,
                                         const int* which, std::size_t moving, double* to,
                                         std::size_t stride) {
  constexpr std::size_t width = Batch<Arch>::size;
  constexpr int n_u = Sizes<M>::n_u;
  constexpr int n_2 = Sizes<M>::n_2;
  using Dual = LaneDual<Arch, inputs_at_a_time>;
  const M& model = *static_cast<const M*>(of_model);
  Vec<Dual, n_2> x;
  for (int k = 0; k < n_2; ++k) x[k] = Dual(xi2[k]);
  const auto settled = hoisting::settle(model, x);
  for (std::size_t row = 0; row < rows; row += width) {
    const std::size_t count = std::min(width, rows - row);
    const Vec<Batch<Arch>, n_u> values = load_rows<Arch, n_u>(inputs, row, count);
    Vec<Dual, n_u> u;
    for (int k = 0; k < n_u; ++k) u[k] = Dual(values[k]);
    for (std::size_t i = 0; i < moving; ++i) u[which[i]].v[i] = Batch<Arch>(1.0);
    const auto z = hoisting::combine(model, hoisting::prepare(model, u), settled);
    for (int j = 0; j < Sizes<M>::n_z; ++j) {
      auto slopes = z.b[j].v;
      for (int c = 0; c < Sizes<M>::n_1; ++c) {
        for (std::size_t i = 0; i < moving; ++i) {
          slopes[i] = xsimd::fma(Batch<Arch>(xi1[c]), z.A(j, c).v[i], slopes[i]);
        }
      }
      double* const own = to + static_cast<std::size_t>(j) * rows + row;
      for (std::size_t i = 0; i < moving; ++i) {
        store_rows<Arch>(slopes[i], count, own + i * stride);
      }
    }
  }
}

/// What prepare() gives of a row.
template <class M>
using Prepared =
    decltype(hoisting::prepare(std::declval<const M&>(), Vec<double, Sizes<M>::n_u>()));

/// Prepared rows are bytes to those that keep them: one that owns something can't be kept so.
template <class M>
constexpr std::size_t prepared_bytes() {
  return std::is_trivially_destructible_v<Prepared<M>> ? sizeof(Prepared<M>) : 0;
}

/// As LaneKernel::prepare.
template <class M>
void prepare_rows(const void* of_model, const double* const* inputs, std::size_t rows, void* to) {
  constexpr int n_u = Sizes<M>::n_u;
  const M& model = *static_cast<const M*>(of_model);
  for (std::size_t i = 0; i < rows; ++i) {
    Vec<double, n_u> u;
    for (int k = 0; k < n_u; ++k) u[k] = inputs[k][i];
    ::new (static_cast<void*>(static_cast<std::byte*>(to) + i * sizeof(Prepared<M>)))
        Prepared<M>(hoisting::prepare(model, u));
  }
}

/// As LaneKernel::fill_trials.
template <class Arch, class M>
[[gnu::flatten]] void fill_trials(const void* of_model, const TrialRows& trials, double* to) {
  constexpr std::size_t width = Batch<Arch>::size;
  constexpr int n_z = Sizes<M>::n_z;
  constexpr int n_1 = Sizes<M>::n_1;
  constexpr int n_2 = Sizes<M>::n_2;
  const auto entry = [](const double* of, std::size_t place) {
    return Batch<Arch>::load_aligned(of + place * width);
  };
  Vec<Batch<Arch>, n_1> xi1;
  for (int k = 0; k < n_1; ++k) xi1[k] = entry(trials.xi1, static_cast<std::size_t>(k));
  Vec<Batch<Arch>, n_2> xi2;
  for (int k = 0; k < n_2; ++k) xi2[k] = entry(trials.xi2, static_cast<std::size_t>(k));
  const TangentAt<Arch, M> tangent(*static_cast<const M*>(of_model), xi1, xi2);
  const auto* const prepared = static_cast<const Prepared<M>*>(trials.prepared);
  const std::size_t stride = trials.rows * width;
  for (std::size_t row = 0; row < trials.rows; ++row) {
    const auto [z, D] = tangent.of(prepared[row]);
    double* own = to + row * width;
    for (int j = 0; j < n_z; ++j) {
      Batch<Arch> value = z.b[j];
      for (int c = 0; c < n_1; ++c, own += stride) {
        z.A(j, c).store_aligned(own);
        value = xsimd::fma(xi1[c], z.A(j, c), value);
      }
      for (int i = 0; i < n_2; ++i, own += stride) D(j, i).store_aligned(own);
      const std::size_t measured = static_cast<std::size_t>(j) * trials.z_stride + row;
      (entry(trials.z, measured) - value).store_aligned(own);
      own += stride;
    }
  }
}

template <class Arch, class M>
constexpr LaneKernel make_kernel() {
  LaneKernel kernel{Batch<Arch>::size, &evaluate_points<Arch, M>, &fill_values<Arch, M>,
                    &fill_tangent<Arch, M>};
  if constexpr (Sizes<M>::n_u > 0 && has_dual_inputs<M>()) {
    kernel.fill_input_tangent = &fill_input_tangent<Arch, M>;
  }
  kernel.prepared_bytes = prepared_bytes<M>();
  kernel.prepare = &prepare_rows<M>;
  kernel.fill_trials = &fill_trials<Arch, M>;
  return kernel;
}

template <class Arch, class M>
inline constexpr LaneKernel kernel_for = make_kernel<Arch, M>();

}  // namespace sepcal::lanes

namespace sepcal {

template <class M>
const LaneKernel& lane_kernel() {
  return lanes::kernel_for<xsimd::default_arch, M>;
}

/// A model that doesn't say so itself, such as one with effects, as one that has lanes. Its at(),
/// and what it takes of others, chooses by where().
template <SeparableModel M>
struct InLanes : M {
  using LanesOf = InLanes;
};

template <SeparableModel M>
InLanes<M> in_lanes(M model) {
  return {std::move(model)};
}

}  // namespace sepcal
