// SPDX-License-Identifier: BSD-3-Clause
// A model's kernel for the instruction set that a program is compiled for. Needs xsimd's headers;
// who fits a model of their own that has lanes includes this beside it.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <xsimd/xsimd.hpp>

#include "sepcal/detail/hoisted_model.hpp"
#include "sepcal/detail/lane_angles.hpp"
#include "sepcal/detail/lane_dual.hpp"
#include "sepcal/detail/lane_kernel.hpp"
#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/model.hpp"

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

/// The inputs of as many rows as lanes, from `row` on.
template <class Arch, int n_u>
Vec<Batch<Arch>, n_u> load_rows(const double* const* inputs, std::size_t row) {
  Vec<Batch<Arch>, n_u> u;
  for (int k = 0; k < n_u; ++k) u[k] = Batch<Arch>::load_unaligned(inputs[k] + row);
  return u;
}

/// visit(row) of as many rows as lanes from each on; the last ones are begun early enough to be as
/// many. No fewer rows than lanes.
template <class Arch, class Visit>
void for_each_group(std::size_t rows, const Visit& visit) {
  constexpr std::size_t width = Batch<Arch>::size;
  for (std::size_t row = 0; row < rows; row += width) {
    visit(row + width <= rows ? row : rows - width);
  }
}

/// Fewer rows than lanes as if they were as many, the last one repeated.
template <class Arch, int n_u>
class FewRows {
  static constexpr std::size_t width = Batch<Arch>::size;

 public:
  explicit FewRows(const LaneRows& rows) : rows_(rows) {
    for (std::size_t k = 0; k < n_u && rows.inputs != nullptr; ++k) {
      double* const own = values_.data() + k * width;
      for (std::size_t i = 0; i < width; ++i) {
        own[i] = rows.inputs[k][i < rows.rows ? i : rows.rows - 1];
      }
      inputs_[k] = own;
    }
  }
  FewRows(const FewRows&) = delete;
  FewRows& operator=(const FewRows&) = delete;
  ~FewRows() = default;

  LaneRows all() const { return {inputs_.data(), width, rows_.kept}; }

  /// fill(rows, to, stride) of `columns` columns of n_z outputs, and of these what belongs to
  /// the few.
  template <int n_z, int columns, class Fill>
  void fill(double* to, std::size_t stride, const Fill& fill) const {
    alignas(Arch::alignment()) double filled[static_cast<std::size_t>(n_z * columns) * width];
    fill(all(), filled, n_z * width);
    for (std::size_t c = 0; c < columns; ++c) {
      for (std::size_t j = 0; j < n_z; ++j) {
        std::copy_n(filled + (c * n_z + j) * width, rows_.rows, to + c * stride + j * rows_.rows);
      }
    }
  }

 private:
  LaneRows rows_;
  std::array<double, static_cast<std::size_t>(n_u) * width> values_;
  std::array<const double*, static_cast<std::size_t>(n_u)> inputs_;
};

/// n numbers, each in every lane.
template <class Arch, int n>
Vec<Batch<Arch>, n> same_in_all(const double* values) {
  Vec<Batch<Arch>, n> x;
  for (int k = 0; k < n; ++k) x[k] = Batch<Arch>(values[k]);
  return x;
}

/// What prepare() gives of as many rows as lanes.
template <class Arch, class M>
using PreparedLanes =
    decltype(hoisting::prepare(std::declval<const M&>(), Vec<Batch<Arch>, Sizes<M>::n_u>()));

/// Prepared rows are bytes to those that keep them: one that owns something can't be kept so.
template <class Arch, class M>
constexpr bool can_keep() {
  return HoistedModel<M> && std::is_trivially_destructible_v<PreparedLanes<Arch, M>>;
}

/// As LaneKernel::keep.
template <class Arch, class M>
void keep_rows(const void* of_model, const double* const* inputs, std::size_t rows, void* to) {
  constexpr int n_u = Sizes<M>::n_u;
  using Row = PreparedLanes<Arch, M>;
  if (rows < Batch<Arch>::size) {
    const FewRows<Arch, n_u> few({inputs, rows});
    return keep_rows<Arch, M>(of_model, few.all().inputs, few.all().rows, to);
  }
  const M& model = *static_cast<const M*>(of_model);
  auto* own = static_cast<std::byte*>(to);
  for_each_group<Arch>(rows, [&](std::size_t row) {
    ::new (static_cast<void*>(own))
        Row(hoisting::prepare(model, load_rows<Arch, n_u>(inputs, row)));
    own += sizeof(Row);
  });
}

/// visit(row, prepared) of as many rows as lanes at a time, no fewer than lanes: those that are
/// kept, or a few at a time made on the way.
template <class Arch, class M, class Visit>
void for_each_prepared(const M& model, const LaneRows& rows, const Visit& visit) {
  constexpr std::size_t width = Batch<Arch>::size;
  constexpr std::size_t groups = 8;
  using Row = PreparedLanes<Arch, M>;
  const std::size_t last = rows.rows - width;
  for (std::size_t first = 0; first < rows.rows; first += groups * width) {
    const std::size_t end = std::min(rows.rows, first + groups * width);
    Row made[groups];
    const Row* prepared = made;
    if (rows.kept != nullptr) {
      prepared = static_cast<const Row*>(rows.kept) + first / width;
    } else {
      Row* next = made;
      for (std::size_t row = first; row < end; row += width) {
        *next++ = hoisting::prepare(
            model, load_rows<Arch, Sizes<M>::n_u>(rows.inputs, std::min(row, last)));
      }
    }
    for (std::size_t row = first; row < end; row += width) {
      visit(std::min(row, last), *prepared++);
    }
  }
}

/// fill_values() of no fewer rows than lanes.
template <class Arch, class M>
[[gnu::flatten]] void fill_groups(const M& model, const LaneRows& rows, const double* xi2,
                                  double* to, std::size_t stride) {
  constexpr int n_z = Sizes<M>::n_z;
  constexpr int n_1 = Sizes<M>::n_1;
  const auto settled = hoisting::settle(model, same_in_all<Arch, Sizes<M>::n_2>(xi2));
  for_each_prepared<Arch>(model, rows, [&](std::size_t row, const auto& of_row) {
    const auto z = hoisting::combine(model, of_row, settled);
    for (int j = 0; j < n_z; ++j) {
      double* own = to + static_cast<std::size_t>(j) * rows.rows + row;
      for (int c = 0; c < n_1; ++c, own += stride) z.A(j, c).store_unaligned(own);
      z.b[j].store_unaligned(own);
    }
  });
}

/// As LaneKernel::fill_values.
template <class Arch, class M>
void fill_values(const void* of_model, const LaneRows& rows, const double* xi2, double* to,
                 std::size_t stride) {
  const M& model = *static_cast<const M*>(of_model);
  if (rows.rows >= Batch<Arch>::size) return fill_groups<Arch>(model, rows, xi2, to, stride);
  FewRows<Arch, Sizes<M>::n_u>(rows).template fill<Sizes<M>::n_z, Sizes<M>::n_1 + 1>(
      to, stride, [&](const LaneRows& all, double* filled, std::size_t apart) {
        fill_groups<Arch>(model, all, xi2, filled, apart);
      });
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

/// fill_tangent() of no fewer rows than lanes.
template <class Arch, class M>
[[gnu::flatten]] void fill_tangent_groups(const M& model, const LaneRows& rows, const double* xi2,
                                          const double* xi1, double* to, std::size_t stride) {
  constexpr int n_z = Sizes<M>::n_z;
  constexpr int n_1 = Sizes<M>::n_1;
  constexpr int n_2 = Sizes<M>::n_2;
  const TangentAt<Arch, M> tangent(model, same_in_all<Arch, n_1>(xi1), same_in_all<Arch, n_2>(xi2));
  for_each_prepared<Arch>(model, rows, [&](std::size_t row, const auto& of_row) {
    const auto [z, D] = tangent.of(of_row);
    for (int j = 0; j < n_z; ++j) {
      double* own = to + static_cast<std::size_t>(j) * rows.rows + row;
      for (int c = 0; c < n_1; ++c, own += stride) z.A(j, c).store_unaligned(own);
      for (int i = 0; i < n_2; ++i, own += stride) D(j, i).store_unaligned(own);
      z.b[j].store_unaligned(own);
    }
  });
}

/// As LaneKernel::fill_tangent.
template <class Arch, class M>
void fill_tangent(const void* of_model, const LaneRows& rows, const double* xi2, const double* xi1,
                  double* to, std::size_t stride) {
  const M& model = *static_cast<const M*>(of_model);
  if (rows.rows >= Batch<Arch>::size) {
    return fill_tangent_groups<Arch>(model, rows, xi2, xi1, to, stride);
  }
  constexpr int columns = Sizes<M>::n_1 + Sizes<M>::n_2 + 1;
  FewRows<Arch, Sizes<M>::n_u>(rows).template fill<Sizes<M>::n_z, columns>(
      to, stride, [&](const LaneRows& all, double* filled, std::size_t apart) {
        fill_tangent_groups<Arch>(model, all, xi2, xi1, filled, apart);
      });
}

/// fill_input_tangent() of no fewer rows than lanes.
template <class Arch, class M>
[[gnu::flatten]] void fill_input_tangent_groups(const M& model, const LaneRows& rows,
                                                const double* xi2, const double* xi1,
                                                const int* which, std::size_t moving, double* to,
                                                std::size_t stride) {
  constexpr int n_u = Sizes<M>::n_u;
  constexpr int n_2 = Sizes<M>::n_2;
  using Dual = LaneDual<Arch, inputs_at_a_time>;
  Vec<Dual, n_2> x;
  for (int k = 0; k < n_2; ++k) x[k] = Dual(xi2[k]);
  const auto settled = hoisting::settle(model, x);
  for_each_group<Arch>(rows.rows, [&](std::size_t row) {
    const Vec<Batch<Arch>, n_u> values = load_rows<Arch, n_u>(rows.inputs, row);
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
      double* own = to + static_cast<std::size_t>(j) * rows.rows + row;
      for (std::size_t i = 0; i < moving; ++i, own += stride) slopes[i].store_unaligned(own);
    }
  });
}

/// As LaneKernel::fill_input_tangent.
template <class Arch, class M>
void fill_input_tangent(const void* of_model, const LaneRows& rows, const double* xi2,
                        const double* xi1, const int* which, std::size_t moving, double* to,
                        std::size_t stride) {
  const M& model = *static_cast<const M*>(of_model);
  if (rows.rows >= Batch<Arch>::size) {
    return fill_input_tangent_groups<Arch>(model, rows, xi2, xi1, which, moving, to, stride);
  }
  // One input after the other, as the columns' number is known when this runs alone.
  const FewRows<Arch, Sizes<M>::n_u> few(rows);
  for (std::size_t i = 0; i < moving; ++i) {
    few.template fill<Sizes<M>::n_z, 1>(
        to + i * stride, stride, [&](const LaneRows& all, double* filled, std::size_t apart) {
          fill_input_tangent_groups<Arch>(model, all, xi2, xi1, which + i, 1, filled, apart);
        });
  }
}

/// What prepare() gives of a row.
template <class M>
using Prepared =
    decltype(hoisting::prepare(std::declval<const M&>(), Vec<double, Sizes<M>::n_u>()));

/// As can_keep().
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
  if constexpr (can_keep<Arch, M>()) {
    kernel.kept_bytes = sizeof(PreparedLanes<Arch, M>);
    kernel.keep = &keep_rows<Arch, M>;
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
