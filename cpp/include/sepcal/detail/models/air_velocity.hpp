// SPDX-License-Identifier: BSD-3-Clause
// What probes have in common that read the air's speed v and two flow angles, against the velocity
// over the ground: V = C_b^n [C(eps) ((1 + lambda_va) v + b_va) d(alpha, beta) - w x r] + W (Sun &
// Gebre-Egziabher, Eqs. 36-42). What each calls its angles is its Direction d.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <numbers>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/hoisted_model.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/detail/models/scale.hpp"
#include "sepcal/detail/rotation.hpp"

namespace sepcal {

/// Direction<X>(alpha, beta) [rad] gives the unit vector at() that the probe meets the air along,
/// in its own axes (forward, right, down), and the slopes of it, by_alpha() and by_beta() [1/rad].
template <template <class> class Direction>
struct AirVelocity {
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

  /// What of a row depends on its inputs alone.
  template <class U>
  struct Prepared {
    Eigen::Matrix<U, 3, 3> C_bn;
    Vec<U, 3> of_rotation;  // C_bn (w x r)
    U airspeed;             // as read
    U alpha;
    U beta;
  };

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
    return place(row, air_direction(angles[0], angles[1], settled));
  }

  /// With d(A xi1 + b)/dxi2 by hand: the air's direction alone moves with xi2.
  template <class U, class X>
  static Tangent<X, 3, 5, 5> tangent(const Prepared<U>& row, const Settled<X>& settled,
                                     const Vec<X, 5>& xi1) {
    const Vec<X, 2> angles = flow_angles<U, X>(row.alpha, row.beta, settled.xi2);
    const Direction<X> air(angles[0], angles[1]);
    const Vec<X, 3> in_body = to_body(air.at(), settled);
    const X speed = row.airspeed * (Real<X>(1) + xi1[0]) + xi1[1];
    const Vec<X, 3> by_alpha = row.C_bn * to_body(air.by_alpha(), settled) * speed;
    const Vec<X, 3> by_beta = row.C_bn * to_body(air.by_beta(), settled) * speed;
    const Vec<X, 3> by_eps = row.C_bn * Vec<X, 3>(X(Real<X>(0)), in_body[2], -in_body[1]) * speed;
    Tangent<X, 3, 5, 5> result{place(row, in_body), {}};
    result.D << by_alpha * row.alpha, by_alpha, by_beta * row.beta, by_beta, by_eps;
    return result;
  }

  /// [alpha, beta] (rad) from the angles as read (Eq. 36).
  template <class U, class X>
  static Vec<X, 2> flow_angles(const U& alpha_read, const U& beta_read, const Vec<X, 5>& xi2) {
    const Real<X> one = 1;
    return {(one + xi2[0]) * alpha_read + xi2[1], (one + xi2[2]) * beta_read + xi2[3]};
  }

  /// C(eps) d(alpha, beta): the air's direction in body axes (Eqs. 38, 41).
  template <class X>
  static Vec<X, 3> air_direction(const X& alpha, const X& beta, const Settled<X>& settled) {
    return to_body(Direction<X>(alpha, beta).at(), settled);
  }

 private:
  /// C(eps) x (Eq. 41).
  template <class X>
  static Vec<X, 3> to_body(const Vec<X, 3>& x, const Settled<X>& settled) {
    return {x[0], settled.cos_eps * x[1] + settled.sin_eps * x[2],
            settled.cos_eps * x[2] - settled.sin_eps * x[1]};
  }

  /// A and b of a row whose air comes from there, in body axes.
  template <class U, class X>
  static Affine<X, 3, 5> place(const Prepared<U>& row, const Vec<X, 3>& in_body) {
    const Vec<X, 3> F = row.C_bn * in_body;
    Affine<X, 3, 5> z;
    z.A.col(0) = F * row.airspeed;                                     // lambda_va
    z.A.col(1) = F;                                                    // b_va
    z.A.template rightCols<3>() = Eigen::Matrix<X, 3, 3>::Identity();  // w_n, w_e, w_d
    z.b = z.A.col(0) - row.of_rotation.template cast<X>();
    return z;
  }
};

}  // namespace sepcal
