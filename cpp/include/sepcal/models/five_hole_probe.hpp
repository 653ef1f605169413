// SPDX-License-Identifier: BSD-3-Clause
// A five-hole Pitot probe calibrated in flight against the inertial velocity
// (Sun & Gebre-Egziabher, Eqs. 36-42):  V = C_b^n [C(eps) V_s - w x r] + W.
#pragma once

#include <array>
#include <cmath>
#include <tuple>

#include "sepcal/detail/models/air_velocity.hpp"

namespace sepcal {

/// Of an angle of attack atan2(w, u) and one of sideslip asin(v / V): [cos a cos b, sin b, sin a
/// cos b] (Eq. 41).
template <class X>
struct SideslipDirection {
  SideslipDirection(const X& alpha, const X& beta) {
    std::tie(cos_a, sin_a) = cos_sin(alpha);
    std::tie(cos_b, sin_b) = cos_sin(beta);
  }
  Vec<X, 3> at() const { return {cos_a * cos_b, sin_b, sin_a * cos_b}; }
  Vec<X, 3> by_alpha() const { return {-sin_a * cos_b, X(Real<X>(0)), cos_a * cos_b}; }
  Vec<X, 3> by_beta() const { return {-cos_a * sin_b, cos_b, -sin_a * sin_b}; }

  X cos_a, sin_a, cos_b, sin_b;
};

/// The last three inputs are ports, zero unless an effect drives them: pressure_offset joins pt -
/// ps where the airspeed is read from it (not where the flow angles are), alpha_offset and
/// beta_offset join the flow angles as read. k_alpha, k_beta: sensitivity of the flow-angle ports,
/// dp/(pt - ps) per radian [1/rad]. lever_arm: from the velocity's reference point to the probe,
/// body axes [m].
struct FiveHoleProbe {
  using Air = AirVelocity<SideslipDirection>;
  static constexpr double ten_degrees = Air::ten_degrees;
  static constexpr std::array inputs{
      Quantity{"roll", "rad"},     Quantity{"pitch", "rad"},  Quantity{"yaw", "rad"},
      Quantity{"p", "rad/s"},      Quantity{"q", "rad/s"},    Quantity{"r", "rad/s"},
      Quantity{"pt", "Pa"},        Quantity{"ps", "Pa"},      Quantity{"dpa", "Pa"},
      Quantity{"dpb", "Pa"},       Quantity{"rho", "kg/m^3"}, port("pressure_offset", "Pa"),
      port("alpha_offset", "rad"), port("beta_offset", "rad")};
  static constexpr auto outputs = Air::outputs;
  static constexpr auto linear = Air::linear;
  static constexpr auto nonlinear = Air::nonlinear;
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;
  static constexpr bool enclosed = true;
  using LanesOf = FiveHoleProbe;

  double k_alpha;
  double k_beta;
  Eigen::Vector3d lever_arm = Eigen::Vector3d::Zero();

  template <class U>
  Air::Prepared<U> prepare(const Vec<U, 14>& u) const {
    using std::sqrt;
    const Real<U> two = 2;
    const auto sensitivity_a = static_cast<Real<U>>(k_alpha);
    const auto sensitivity_b = static_cast<Real<U>>(k_beta);
    enum { roll, pitch, yaw, p, q, r, pt, ps, dpa, dpb, rho, d_pressure, d_alpha, d_beta };
    const U pressure = u[pt] - u[ps];
    const Eigen::Matrix<U, 3, 3> C_bn = body_to_ned<U>(u[roll], u[pitch], u[yaw]);
    const Vec<U, 3> rates(u[p], u[q], u[r]);
    const Vec<U, 3> arm = lever_arm.template cast<U>();
    return {C_bn, C_bn * rates.cross(arm), sqrt(two * (pressure + u[d_pressure]) / u[rho]),
            u[dpa] / (sensitivity_a * pressure) + u[d_alpha],
            u[dpb] / (sensitivity_b * pressure) + u[d_beta]};
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
  Affine<X, 3, 5> at(const Vec<U, 14>& u, const Vec<X, 5>& xi2) const {
    return combine<U, X>(prepare<U>(u), settle<X>(xi2));
  }
};

}  // namespace sepcal
