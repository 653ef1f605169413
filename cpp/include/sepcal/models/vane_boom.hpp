// SPDX-License-Identifier: BSD-3-Clause
// A boom with two vanes and a Pitot tube calibrated in flight against the velocity over the ground:
// V = C_b^n [C(eps) V_s - w x r] + W. A vane reads the angle of the flow in its plane, tan alpha =
// w / u, and the one across is a flank angle, tan beta = v / u.
#pragma once

#include <array>
#include <cmath>
#include <tuple>

#include "sepcal/detail/models/air_velocity.hpp"

namespace sepcal {

/// Of an angle of attack atan2(w, u) and a flank angle atan2(v, u): [1, tan b, tan a] / sqrt(1 +
/// tan^2 a + tan^2 b), here by sines and cosines, n = cos a cos b times that root.
template <class X>
struct FlankDirection {
  FlankDirection(const X& alpha, const X& beta) {
    using std::sqrt;
    std::tie(cos_a, sin_a) = cos_sin(alpha);
    std::tie(cos_b, sin_b) = cos_sin(beta);
    const X down = sin_a * cos_b;
    per_n = X(Real<X>(1)) / sqrt(cos_a * cos_a + down * down);
  }
  Vec<X, 3> at() const { return along() * per_n; }
  /// n^2 has the slopes -2 sin a cos a sin^2 b and -2 sin^2 a sin b cos b.
  Vec<X, 3> by_alpha() const {
    const Vec<X, 3> slope(-sin_a * cos_b, -sin_a * sin_b, cos_a * cos_b);
    return (slope + along() * (sin_a * cos_a * sin_b * sin_b * per_n * per_n)) * per_n;
  }
  Vec<X, 3> by_beta() const {
    const Vec<X, 3> slope(-cos_a * sin_b, cos_a * cos_b, -sin_a * sin_b);
    return (slope + along() * (sin_a * sin_a * sin_b * cos_b * per_n * per_n)) * per_n;
  }

  X cos_a, sin_a, cos_b, sin_b, per_n;

 private:
  Vec<X, 3> along() const { return {cos_a * cos_b, cos_a * sin_b, sin_a * cos_b}; }
};

/// airspeed: as read [m/s]; alpha, beta: the vanes' angles as read [rad], within +-90 deg. The last
/// three inputs are ports, zero unless an effect drives them: pressure_offset joins the impact
/// pressure rho v^2 / 2 that the airspeed is read from, alpha_offset and beta_offset join the
/// angles as read. lambda_alpha, lambda_beta: upwash and sidewash at the boom. lever_arm: from the
/// velocity's reference point to the boom's head, body axes [m].
struct VaneBoom {
  using Air = AirVelocity<FlankDirection>;
  static constexpr double sea_level_density = 1.225;  // [kg/m^3], ISO 2533
  static constexpr std::array inputs{
      Quantity{"roll", "rad"},
      Quantity{"pitch", "rad"},
      Quantity{"yaw", "rad"},
      Quantity{"p", "rad/s"},
      Quantity{"q", "rad/s"},
      Quantity{"r", "rad/s"},
      Quantity{"airspeed", "m/s"},
      Quantity{"alpha", "rad"},
      Quantity{"beta", "rad"},
      Quantity{"rho", "kg/m^3", -infinity, infinity, sea_level_density},
      port("pressure_offset", "Pa"),
      port("alpha_offset", "rad"),
      port("beta_offset", "rad")};
  static constexpr auto outputs = Air::outputs;
  static constexpr auto linear = Air::linear;
  static constexpr auto nonlinear = Air::nonlinear;
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;
  static constexpr bool enclosed = true;
  using LanesOf = VaneBoom;

  Eigen::Vector3d lever_arm = Eigen::Vector3d::Zero();

  template <class U>
  Air::Prepared<U> prepare(const Vec<U, 13>& u) const {
    using std::sqrt;
    const Real<U> two = 2;
    enum { roll, pitch, yaw, p, q, r, airspeed, alpha, beta, rho, d_pressure, d_alpha, d_beta };
    const Eigen::Matrix<U, 3, 3> C_bn = body_to_ned<U>(u[roll], u[pitch], u[yaw]);
    const Vec<U, 3> rates(u[p], u[q], u[r]);
    const Vec<U, 3> arm = lever_arm.template cast<U>();
    return {C_bn, C_bn * rates.cross(arm),
            sqrt(u[airspeed] * u[airspeed] + two * u[d_pressure] / u[rho]), u[alpha] + u[d_alpha],
            u[beta] + u[d_beta]};
  }

  template <class X>
  static Air::Settled<X> settle(const Vec<X, 5>& xi2) {
    return Air::settle(xi2);
  }

  template <class U, class X>
  static Affine<X, 3, 5> combine(const Air::Prepared<U>& row, const Air::Settled<X>& settled) {
    return Air::combine(row, settled);
  }

  template <class U, class X>
  static Tangent<X, 3, 5, 5> tangent(const Air::Prepared<U>& row, const Air::Settled<X>& settled,
                                     const Vec<X, 5>& xi1) {
    return Air::tangent(row, settled, xi1);
  }

  template <class U, class X>
  Affine<X, 3, 5> at(const Vec<U, 13>& u, const Vec<X, 5>& xi2) const {
    return Air::combine(prepare<U>(u), settle<X>(xi2));
  }
};

}  // namespace sepcal
