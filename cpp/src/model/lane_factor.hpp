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
/// [T; rows]; rows: column c, row i (of m) in the lanes from c * stride + i * width on, left
/// destroyed.
template <class Arch, int n>
class LaneFactor {
  using B = xsimd::batch<double, Arch>;
  static constexpr std::size_t width = B::size;

 public:
  /// Whether every lane was safe.
  static bool absorb(double* T, double* rows, std::size_t m, std::size_t stride) {
    B dots[n];
    for (B& dot : dots) dot = B(0.0);
    for (std::size_t i = 0; i < m; ++i) {
      const B x = at(rows, i);
      for (int j = 0; j < n; ++j) {
        dots[j] = xsimd::fma(x, at(rows + static_cast<std::size_t>(j) * stride, i), dots[j]);
      }
    }
    return step<0>(T, rows, m, stride, dots);
  }

 private:
  static B at(const double* values, std::size_t i) { return B::load_aligned(values + i * width); }

  static constexpr std::size_t place(int row, int column) {
    constexpr std::size_t columns = n;
    return static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
  }

  /// dots[j] = x_k . x_j of the rows' columns, j >= k.
  template <int k>
  static bool step(double* T, double* rows, std::size_t m, std::size_t stride, const B* dots) {
    B row[n];
    for (int j = k; j < n; ++j) row[j] = at(T, place(k, j));
    const B tail = dots[k];
    const auto none = tail == B(0.0);
    const bool safe = xsimd::all(none || (tail > B(numerics::smallest_safe_square) &&
                                          tail < B(numerics::largest_safe_square))) &&
                      (!xsimd::any(none) || is_zero(rows + k * stride, m, none));
    const B length = xsimd::sqrt(xsimd::fma(row[k], row[k], tail));
    const B reflected = xsimd::select(row[k] > B(0.0), -length, length);
    const B v0 = row[k] - reflected;
    const B inverse = xsimd::select(none, B(0.0), B(1.0) / v0);
    const B tau = xsimd::select(none, B(0.0), -v0 / reflected);
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
        const B x = at(rows + k * stride, i);
        B y[n];
        for (int j = k + 1; j < n; ++j) {
          double* const to = rows + static_cast<std::size_t>(j) * stride + i * width;
          y[j] = xsimd::fnma(x, w[j], B::load_aligned(to));
          y[j].store_aligned(to);
        }
        for (int j = k + 1; j < n; ++j) next[j] = xsimd::fma(y[k + 1], y[j], next[j]);
      }
      return step<k + 1>(T, rows, m, stride, next) && safe;
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
