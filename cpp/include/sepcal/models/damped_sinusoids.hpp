// SPDX-License-Identifier: BSD-3-Clause
// Damped sinusoids out of samples, what Prony's method looks for (Hauer, Demeure & Scharf 1990, the
// paper's example of a separable problem with a method of its own):
//   z = sum_k exp(-damping_k t) (cos_k cos(omega_k t) + sin_k sin(omega_k t)) + offset + v.
// Amplitudes are linear, frequencies and dampings are sampled by stage one, and no start is needed.
// Times may be irregular; estimates are those of least squares, which linear prediction's are not.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/model.hpp"

namespace sepcal {

/// 1 to 6 modes, the fastest first. Two of them could change places and fit as well; frequencies
/// are therefore one frequency and ratios: omega_1 = frequency_1, omega_2 = ratio_2 omega_1,
/// omega_3 = ratio_3 omega_2, ratios within [0, 1]. Frequency and dampings have no upper bounds of
/// their own: FitOptions::bounds gives what the sampling rate allows, below pi over its interval.
template <int Modes>
struct DampedSinusoids {
  static_assert(Modes >= 1 && Modes <= 6, "1 to 6 modes");

  static constexpr std::array inputs{Quantity{"time", "s"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr auto linear = [] {
    constexpr std::array<std::string_view, 12> names{"cos_1", "sin_1", "cos_2", "sin_2",
                                                     "cos_3", "sin_3", "cos_4", "sin_4",
                                                     "cos_5", "sin_5", "cos_6", "sin_6"};
    constexpr std::size_t waves = 2 * std::size_t{Modes};
    std::array<Quantity, waves + 1> table{};
    for (std::size_t k = 0; k < waves; ++k) table[k] = {names[k], "1"};
    table[waves] = {"offset", "1"};
    return table;
  }();
  static constexpr auto nonlinear = [] {
    constexpr std::array<std::string_view, 6> ratios{"",        "ratio_2", "ratio_3",
                                                     "ratio_4", "ratio_5", "ratio_6"};
    constexpr std::array<std::string_view, 6> dampings{"damping_1", "damping_2", "damping_3",
                                                       "damping_4", "damping_5", "damping_6"};
    std::array<Quantity, 2 * std::size_t{Modes}> table{};
    table[0] = {"frequency_1", "rad/s", 0.0};
    for (std::size_t k = 1; k < Modes; ++k) table[k] = {ratios[k], "1", 0.0, 1.0};
    for (std::size_t k = 0; k < Modes; ++k) table[Modes + k] = {dampings[k], "1/s", 0.0};
    return table;
  }();
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;

  template <class U, class X>
  Affine<X, 1, 2 * Modes + 1> at(const Vec<U, 1>& time, const Vec<X, 2 * Modes>& xi2) const {
    using std::cos;
    using std::exp;
    using std::sin;
    Affine<X, 1, 2 * Modes + 1> z;
    X omega(Real<X>(1));
    for (int k = 0; k < Modes; ++k) {
      omega = omega * xi2[k];
      const X decay = exp(-xi2[Modes + k] * time[0]);
      const X angle = omega * time[0];
      z.A(0, 2 * k) = decay * cos(angle);
      z.A(0, 2 * k + 1) = decay * sin(angle);
    }
    z.A(0, 2 * Modes) = X(Real<X>(1));
    z.b[0] = X(Real<X>(0));
    return z;
  }
};

}  // namespace sepcal
