// SPDX-License-Identifier: BSD-3-Clause
// A plain Pitot-static tube calibrated in flight against the ground velocity: it reads
// z = s_va V + c_va, V = |v_ground - W| the true airspeed. Effects act at the tube, which meets
// V_met = sqrt(((V - airspeed_bias) / (1 + airspeed_scale))^2 - 2 pressure_offset / rho).
#pragma once

#include <array>
#include <cmath>

#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/detail/models/scale.hpp"

namespace sepcal {

/// The wind is nonlinear here, in a norm; of its components the vertical one is seldom seen.
struct PitotStatic {
  static constexpr double sea_level_density = 1.225;  // [kg/m^3], ISO 2533
  static constexpr std::array inputs{
      Quantity{"vn", "m/s"},
      Quantity{"ve", "m/s"},
      Quantity{"vd", "m/s"},
      port("airspeed_scale", "1"),
      port("airspeed_bias", "m/s"),
      port("pressure_offset", "Pa"),
      Quantity{"rho", "kg/m^3", -infinity, infinity, sea_level_density}};
  static constexpr std::array outputs{Quantity{"airspeed", "m/s"}};
  static constexpr std::array linear{Quantity{"s_va", "1", least_scale, infinity},
                                     Quantity{"c_va", "m/s"}};
  static constexpr std::array nonlinear{Quantity{"w_n", "m/s", -100, 100},
                                        Quantity{"w_e", "m/s", -100, 100},
                                        Quantity{"w_d", "m/s", -100, 100}};
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;
  static constexpr bool enclosed = true;
  using LanesOf = PitotStatic;

  template <class U, class X>
  Affine<X, 1, 2> at(const Vec<U, 7>& u, const Vec<X, 3>& wind) const {
    enum { vn, ve, vd, airspeed_scale, airspeed_bias, pressure_offset, rho };
    const X north = u[vn] - wind[0];
    const X east = u[ve] - wind[1];
    const X down = u[vd] - wind[2];
    const X airspeed = root(X(north * north + east * east + down * down));
    const X undisturbed = (airspeed - u[airspeed_bias]) / (Real<U>(1) + u[airspeed_scale]);
    const U offset = Real<U>(2) * u[pressure_offset] / u[rho];
    Affine<X, 1, 2> z;
    z.A(0, 0) = root(X(undisturbed * undisturbed - offset));
    z.A(0, 1) = X(Real<X>(1));
    z.b[0] = X(Real<X>(0));
    return z;
  }

  /// The wind from where the ground velocity's circles lie: |v - W|^2 = a z^2 + b is linear in W, a
  /// and b - |W|^2. A column, or none where the record doesn't turn.
  static Eigen::MatrixXd guess(const Eigen::MatrixXd& u, const Eigen::MatrixXd& z);

 private:
  /// sqrt(square + floor^2), the floor 1e-6 m/s: it has a slope at rest too, and above 0.1 m/s it
  /// is sqrt(square) to 1e-10. A square below zero (an offset that outweighs the air) counts as
  /// zero.
  template <class X>
  static X root(const X& square) {
    using std::sqrt;
    const auto floor = static_cast<Real<X>>(1e-6);  // [m/s]
    const Real<X> zero = 0;
    return where(square < zero, X(floor),
                 X(sqrt(where(square < zero, X(zero), square) + floor * floor)));
  }
};

}  // namespace sepcal
