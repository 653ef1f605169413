// SPDX-License-Identifier: BSD-3-Clause
// A five-hole Pitot probe calibrated in flight against the inertial velocity
// (Sun & Gebre-Egziabher, Eqs. 36-42):  V = C_b^n [C(eps) V_s - w x r] + W.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

#include "sepcal/eigen.hpp"
#include "sepcal/model.hpp"
#include "sepcal/models/scale.hpp"
#include "sepcal/rotation.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

/// The last three inputs are ports, zero unless an effect drives them: pressure_offset joins pt -
/// ps where the airspeed is read from it (not where the flow angles are), alpha_offset and
/// beta_offset join the flow angles as read. k_alpha, k_beta: sensitivity of the flow-angle ports,
/// dp/(pt - ps) per radian [1/rad]. lever_arm: from the velocity's reference point to the probe,
/// body axes [m].
struct FiveHoleProbe {
  static constexpr std::array inputs{
      Quantity{"roll", "rad"},     Quantity{"pitch", "rad"},  Quantity{"yaw", "rad"},
      Quantity{"p", "rad/s"},      Quantity{"q", "rad/s"},    Quantity{"r", "rad/s"},
      Quantity{"pt", "Pa"},        Quantity{"ps", "Pa"},      Quantity{"dpa", "Pa"},
      Quantity{"dpb", "Pa"},       Quantity{"rho", "kg/m^3"}, port("pressure_offset", "Pa"),
      port("alpha_offset", "rad"), port("beta_offset", "rad")};
  static constexpr std::array outputs{Quantity{"vn", "m/s"}, Quantity{"ve", "m/s"},
                                      Quantity{"vd", "m/s"}};
  static constexpr std::array linear{scale_error("lambda_va"), Quantity{"b_va", "m/s"},
                                     Quantity{"w_n", "m/s"}, Quantity{"w_e", "m/s"},
                                     Quantity{"w_d", "m/s"}};
  static constexpr double ten_degrees = 10.0 * std::numbers::pi / 180.0;
  static constexpr std::array nonlinear{Quantity{"lambda_alpha", "1", -0.5, 0.5},
                                        Quantity{"b_alpha", "rad", -ten_degrees, ten_degrees},
                                        Quantity{"lambda_beta", "1", -0.5, 0.5},
                                        Quantity{"b_beta", "rad", -ten_degrees, ten_degrees},
                                        Quantity{"eps_phi", "rad", -0.2618, 0.2618}};
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;
  using LanesOf = FiveHoleProbe;

  double k_alpha;
  double k_beta;
  Eigen::Vector3d lever_arm = Eigen::Vector3d::Zero();

  /// What of a row depends on its inputs alone.
  template <class U>
  struct Prepared {
    Eigen::Matrix<U, 3, 3> C_bn;
    Vec<U, 3> of_rotation;  // C_bn (w x r)
    U airspeed;             // as read
    U alpha;
    U beta;
  };

  template <class U>
  Prepared<U> prepare(const Vec<U, 14>& u) const {
    using std::sqrt;
    enum { roll, pitch, yaw, p, q, r, pt, ps, dpa, dpb, rho, d_pressure, d_alpha, d_beta };
    const U pressure = u[pt] - u[ps];
    const Eigen::Matrix<U, 3, 3> C_bn = body_to_ned<U>(u[roll], u[pitch], u[yaw]);
    const Vec<U, 3> rates(u[p], u[q], u[r]);
    const Vec<U, 3> arm = lever_arm.template cast<U>();
    return {C_bn, C_bn * rates.cross(arm), sqrt(2.0 * (pressure + u[d_pressure]) / u[rho]),
            u[dpa] / (k_alpha * pressure) + u[d_alpha], u[dpb] / (k_beta * pressure) + u[d_beta]};
  }

  /// What depends on xi2 alone.
  template <class X>
  struct Settled {
    Vec<X, 5> xi2;
    X cos_eps;
    X sin_eps;
  };

  template <class X>
  static Settled<X> settle(const Vec<X, 5>& xi2) {
    const auto [cosine, sine] = cos_sin(xi2[4]);
    return {xi2, cosine, sine};
  }

  template <class U, class X>
  static Affine<X, 3, 5> combine(const Prepared<U>& row, const Settled<X>& settled) {
    const Vec<X, 2> angles = flow_angles<U, X>(row.alpha, row.beta, settled.xi2);
    const Vec<X, 3> F = row.C_bn * air_direction<X>(angles[0], angles[1], settled);
    Affine<X, 3, 5> z;
    z.A.col(0) = F * row.airspeed;                                     // lambda_va
    z.A.col(1) = F;                                                    // b_va
    z.A.template rightCols<3>() = Eigen::Matrix<X, 3, 3>::Identity();  // w_n, w_e, w_d
    z.b = z.A.col(0) - row.of_rotation.template cast<X>();
    return z;
  }

  template <class U, class X>
  Affine<X, 3, 5> at(const Vec<U, 14>& u, const Vec<X, 5>& xi2) const {
    return combine<U, X>(prepare<U>(u), settle<X>(xi2));
  }

  /// [alpha, beta] (rad) from the angles as read (Eq. 36).
  template <class U, class X>
  static Vec<X, 2> flow_angles(const U& alpha_read, const U& beta_read, const Vec<X, 5>& xi2) {
    return {(1.0 + xi2[0]) * alpha_read + xi2[1], (1.0 + xi2[2]) * beta_read + xi2[3]};
  }

  /// C(eps) [cos a cos b, sin b, sin a cos b]: the air's direction in body axes (Eqs. 38, 41).
  template <class X>
  static Vec<X, 3> air_direction(const X& alpha, const X& beta, const Settled<X>& settled) {
    const auto [cos_a, sin_a] = cos_sin(alpha);
    const auto [cos_b, sin_b] = cos_sin(beta);
    const X z = sin_a * cos_b;
    return {cos_a * cos_b, settled.cos_eps * sin_b + settled.sin_eps * z,
            settled.cos_eps * z - settled.sin_eps * sin_b};
  }
};

template <>
const LaneKernel& lane_kernel<FiveHoleProbe>();
extern template class StaticModel<FiveHoleProbe>;

}  // namespace sepcal
