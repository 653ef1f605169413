// SPDX-License-Identifier: BSD-3-Clause
// Triangular factors side by side, one a lane: TriangularFactor::absorb() of each, without its
// care for squares that underflow or overflow. Lanes that would need it are told, and their rows
// go the scalar way.
#pragma once

#include <cstddef>
#include <xsimd/xsimd.hpp>

#include "numerics/safe_squares.hpp"

namespace sepcal::lanes {

/// T (n x n, upper; row i, column j in the lanes from (i * n + j) * width on) becomes the factor of
/// [T; rows]; rows: column c, row i (of m) in the lanes from columns[c] + i * width on, left
/// destroyed.
template <class Arch, int n>
class LaneFactor {
  using B = xsimd::batch<double, Arch>;
  static constexpr std::size_t width = B::size;

 public:
  /// Whether every lane was safe.
  static bool absorb(double* T, double* const* columns, std::size_t m) {
    B dots[n];
    for (B& dot : dots) dot = B(0.0);
    for (std::size_t i = 0; i < m; ++i) {
      const B x = at(columns[0], i);
      for (int j = 0; j < n; ++j) dots[j] = xsimd::fma(x, at(columns[j], i), dots[j]);
    }
    return step<0>(T, columns, m, dots);
  }

 private:
  static B at(const double* values, std::size_t i) { return B::load_aligned(values + i * width); }

  static constexpr std::size_t place(int row, int column) {
    constexpr std::size_t columns = n;
    return static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
  }

  /// dots[j] = x_k . x_j of the rows' columns, j >= k.
  template <int k>
  static bool step(double* T, double* const* columns, std::size_t m, const B* dots) {
    B row[n];
    for (int j = k; j < n; ++j) row[j] = at(T, place(k, j));
    const B tail = dots[k];
    const auto none = tail == B(0.0);
    const bool safe = xsimd::all(none || (tail > B(numerics::smallest_safe_square) &&
                                          tail < B(numerics::largest_safe_square))) &&
                      (!xsimd::any(none) || is_zero(columns[k], m, none));
    const B length = xsimd::sqrt(xsimd::fma(row[k], row[k], tail));
    const B reflected = xsimd::select(row[k] > B(0.0), -length, length);
    const B v0 = row[k] - reflected;
    // One division for 1 / v0 and v0 / reflected: a panel's steps wait for each.
    const B shared = xsimd::select(none, B(0.0), B(1.0) / (v0 * reflected));
    const B inverse = shared * reflected;
    const B tau = -v0 * v0 * shared;
    xsimd::select(none, row[k], reflected).store_aligned(T + place(k, k) * width);
    if constexpr (k + 1 == n) {
      return safe;
    } else {
      B w[n];
      for (int j = k + 1; j < n; ++j) {
        w[j] = tau * xsimd::fma(dots[j], inverse, row[j]);
        (row[j] - w[j]).store_aligned(T + place(k, j) * width);
        w[j] *= inverse;
      }
      B next[n];
      for (int j = k + 1; j < n; ++j) next[j] = B(0.0);
      for (std::size_t i = 0; i < m; ++i) {
        const B x = at(columns[k], i);
        B y[n];
        for (int j = k + 1; j < n; ++j) {
          double* const to = columns[j] + i * width;
          y[j] = xsimd::fnma(x, w[j], B::load_aligned(to));
          y[j].store_aligned(to);
        }
        for (int j = k + 1; j < n; ++j) next[j] = xsimd::fma(y[k + 1], y[j], next[j]);
      }
      return step<k + 1>(T, columns, m, next) && safe;
    }
  }

  /// Whether a column whose square is zero is zero itself.
  static bool is_zero(const double* column, std::size_t m,
                      const xsimd::batch_bool<double, Arch>& none) {
    for (std::size_t i = 0; i < m; ++i) {
      if (xsimd::any(none && at(column, i) != B(0.0))) return false;
    }
    return true;
  }
};

}  // namespace sepcal::lanes
