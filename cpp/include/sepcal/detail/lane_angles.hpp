// SPDX-License-Identifier: BSD-3-Clause
// Sine and cosine side by side. Most angles of a model are small, a vane's or a misalignment's:
// where all lanes are within an eighth of a turn, the two polynomials are all that it takes, at
// half the price of a reduction to that range.
#pragma once

#include <numbers>
#include <utility>
#include <xsimd/xsimd.hpp>

namespace sepcal::lanes {

/// sum_k c_k z^k.
template <class B>
B horner(const B& /*z*/, double last) {
  return B(last);
}
template <class B, class... Rest>
B horner(const B& z, double first, Rest... rest) {
  return xsimd::fma(z, horner(z, rest...), B(first));
}

/// [cos x, sin x] to an ulp, |x| <= pi/4; coefficients nearest in the largest error, as fdlibm has
/// them.
template <class B>
std::pair<B, B> cos_sin_of_small(const B& x) {
  const B z = x * x;
  const B cosine = horner(z, 0.5, -4.16666666666666019037e-02, 1.38888888888741095749e-03,
                          -2.48015872894767294178e-05, 2.75573143513906633035e-07,
                          -2.08757232129817482790e-09, 1.13596475577881948265e-11);
  const B sine = horner(z, -1.66666666666666324348e-01, 8.33333333332248946124e-03,
                        -1.98412698298579493134e-04, 2.75573137070700676789e-06,
                        -2.50507602534068634195e-08, 1.58969099521155010221e-10);
  return {xsimd::fnma(cosine, z, B(1.0)), xsimd::fma(sine * z, x, x)};
}

/// [cos x, sin x]. Those of a small angle are the same whatever the lanes beside it hold.
template <class B>
std::pair<B, B> cos_sin(const B& x) {
  const auto is_small = xsimd::abs(x) <= B(0.25 * std::numbers::pi);
  const auto small = cos_sin_of_small(x);
  if (xsimd::all(is_small)) return small;
  const auto [sine, cosine] = xsimd::sincos(x);
  return {xsimd::select(is_small, small.first, cosine),
          xsimd::select(is_small, small.second, sine)};
}

}  // namespace sepcal::lanes
