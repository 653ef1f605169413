// SPDX-License-Identifier: BSD-3-Clause
// Triangular factors side by side, one a lane: TriangularFactor::absorb() of each, without its
// care for squares that underflow or overflow. Lanes that would need it are told, and their rows
// go the scalar way. Panels of several outputs go in step: a reflector's root and division are
// waited for once.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <xsimd/xsimd.hpp>

#include "model/lane_kit.hpp"
#include "numerics/safe_squares.hpp"

namespace sepcal::lanes {

template <class Arch, std::size_t n>
class LaneFactor {
  using B = xsimd::batch<double, Arch>;
  static constexpr std::size_t width = B::size;

 public:
  /// As AbsorbPanels, of n columns.
  static bool absorb(const Panel* panels, std::size_t count, std::size_t m) {
    Steps steps;
    for (std::size_t p = 0; p < count; ++p) {
      const Panel panel = panels[p];
      add_up<0>(m, steps[p], [&](std::size_t i, B(&y)[n]) {
        for (std::size_t j = 0; j < n; ++j) y[j] = at(panel.columns[j], i);
      });
    }
    return step<0>(panels, count, m, steps);
  }

 private:
  /// Of each panel, by column: x_k . x_j, then what is taken off x_j a unit of x_k.
  using Steps = std::array<std::array<B, n>, most_panels>;

  static B at(const double* values, std::size_t i) { return B::load_aligned(values + i * width); }

  static constexpr std::size_t place(std::size_t row, std::size_t column) {
    return row * n + column;
  }

  /// steps: x_k . x_j of the rows' columns, j >= k.
  template <std::size_t k>
  static bool step(const Panel* panels, std::size_t count, std::size_t m, Steps& steps) {
    bool safe = true;
    for (std::size_t p = 0; p < count; ++p) {
      safe = reflect<k>(panels[p], m, steps[p]) && safe;
    }
    if constexpr (k + 1 < n) {
      for (std::size_t p = 0; p < count; ++p) apply<k>(panels[p], m, steps[p]);
      safe = step<k + 1>(panels, count, m, steps) && safe;
    }
    return safe;
  }

  /// T's row k; dots become what apply() takes off.
  template <std::size_t k>
  static bool reflect(const Panel& panel, std::size_t m, std::array<B, n>& dots) {
    double* const T = panel.T;
    B row[n];
    for (std::size_t j = k; j < n; ++j) row[j] = at(T, place(k, j));
    const B tail = dots[k];
    const auto none = tail == B(0.0);
    const bool safe = xsimd::all(none || (tail > B(numerics::smallest_safe_square) &&
                                          tail < B(numerics::largest_safe_square))) &&
                      (!xsimd::any(none) || is_zero(panel.columns[k], m, none));
    const B length = xsimd::sqrt(xsimd::fma(row[k], row[k], tail));
    const B reflected = xsimd::select(row[k] > B(0.0), -length, length);
    const B v0 = row[k] - reflected;
    // One division for 1 / v0 and v0 / reflected.
    const B shared = xsimd::select(none, B(0.0), B(1.0) / (v0 * reflected));
    const B inverse = shared * reflected;
    const B tau = -v0 * v0 * shared;
    xsimd::select(none, row[k], reflected).store_aligned(T + place(k, k) * width);
    for (std::size_t j = k + 1; j < n; ++j) {
      const B w = tau * xsimd::fma(dots[j], inverse, row[j]);
      (row[j] - w).store_aligned(T + place(k, j) * width);
      dots[j] = w * inverse;
    }
    return safe;
  }

  /// Takes w[j] x_k off each x_j, j > k; w becomes x_k+1 . x_j.
  template <std::size_t k>
  static void apply(const Panel& panel, std::size_t m, std::array<B, n>& w) {
    B off[n];
    double* own[n];
    for (std::size_t j = k + 1; j < n; ++j) off[j] = w[j];
    for (std::size_t j = k; j < n; ++j) own[j] = panel.columns[j];
    add_up<k + 1>(m, w, [&](std::size_t i, B(&y)[n]) {
      const B x = at(own[k], i);
      for (std::size_t j = k + 1; j < n; ++j) {
        double* const to = own[j] + i * width;
        y[j] = xsimd::fnma(x, off[j], B::load_aligned(to));
        y[j].store_aligned(to);
      }
    });
  }

  /// sums[j] = sum_i y_k y_j of what row(i, y) gives, j >= k. Few sums alone would wait for each
  /// other's additions: they are of every second row, then.
  template <std::size_t k, class Row>
  static void add_up(std::size_t m, std::array<B, n>& sums, const Row& row) {
    constexpr std::size_t parts = n - k >= 6 ? 1 : 2;
    B partial[parts][n];
    for (auto& part : partial) {
      for (std::size_t j = k; j < n; ++j) part[j] = B(0.0);
    }
    std::size_t i = 0;
    for (; i + parts <= m; i += parts) {
      for (std::size_t part = 0; part < parts; ++part) {
        B y[n];
        row(i + part, y);
        for (std::size_t j = k; j < n; ++j)
          partial[part][j] = xsimd::fma(y[k], y[j], partial[part][j]);
      }
    }
    for (; i < m; ++i) {
      B y[n];
      row(i, y);
      for (std::size_t j = k; j < n; ++j) partial[0][j] = xsimd::fma(y[k], y[j], partial[0][j]);
    }
    for (std::size_t j = k; j < n; ++j) {
      sums[j] = partial[0][j];
      for (std::size_t part = 1; part < parts; ++part) sums[j] += partial[part][j];
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
