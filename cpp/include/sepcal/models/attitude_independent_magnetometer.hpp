// SPDX-License-Identifier: BSD-3-Clause
// A three-axis magnetometer of which only the field's strength F is known: m = C h + n, |h| = F,
// C = C_alpha C_lambda. With y = C^-1 (m - n), u = y/|y|, M = C^-1 C^-T and noise of standard
// deviation sigma in m, 0 = (|y| - F - mu) / |C^-T u| + noise, mu = sigma^2 (tr M - u'M u) / 2F:
// mu is what the noise adds to |y| on average, which would bias C and n.
#pragma once

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/model.hpp"

namespace sepcal {

/// field_strength: F [uT]; where the field changes along the record, the input field_change is what
/// a row's has more. noise: sigma [uT]; 0 leaves mu out. A rotation of the sensor is not seen in
/// |y|, so C has no misalignment. n has no bounds of its own: they depend on the readings. The
/// output `field` is zero in every row, and A has no columns.
struct AttitudeIndependentMagnetometer {
  static constexpr std::array inputs{Quantity{"mx", "uT"},      Quantity{"my", "uT"},
                                     Quantity{"mz", "uT"},      port("scale", "1"),
                                     port("axis_scale_x", "1"), port("axis_scale_y", "1"),
                                     port("axis_scale_z", "1"), port("field_change", "uT")};
  static constexpr std::array outputs{Quantity{"field", "uT", -infinity, infinity, 0.0}};
  static constexpr std::array<Quantity, 0> linear{};
  static constexpr std::array nonlinear{Quantity{"lambda_x", "1", -0.5, 0.5},
                                        Quantity{"lambda_y", "1", -0.5, 0.5},
                                        Quantity{"lambda_z", "1", -0.5, 0.5},
                                        Quantity{"alpha_xy", "1", -0.5, 0.5},
                                        Quantity{"alpha_xz", "1", -0.5, 0.5},
                                        Quantity{"alpha_yz", "1", -0.5, 0.5},
                                        Quantity{"n_x", "uT"},
                                        Quantity{"n_y", "uT"},
                                        Quantity{"n_z", "uT"}};
  static constexpr bool dual_inputs = true;
  static constexpr bool nested_duals = true;
  using LanesOf = AttitudeIndependentMagnetometer;

  double field_strength;
  double noise = 0.0;

  /// What of a row depends on its inputs alone.
  template <class U>
  struct Prepared {
    Vec<U, 3> m;
    Vec<U, 3> scale;  // the ports', beside lambda
    U field_change;
    bool plain;  // no port is driven
  };

  template <class U>
  static Prepared<U> prepare(const Vec<U, 8>& u) {
    enum { mx, my, mz, scale, axis_scale, field_change = axis_scale + 3 };
    const Vec<U, 3> joined(u[scale] + u[axis_scale], u[scale] + u[axis_scale + 1],
                           u[scale] + u[axis_scale + 2]);
    return {Vec<U, 3>(u[mx], u[my], u[mz]), joined, u[field_change],
            vanishes(joined[0]) && vanishes(joined[1]) && vanishes(joined[2]) &&
                vanishes(u[field_change])};
  }

  /// What depends on xi2 alone.
  template <class X>
  struct Settled {
    Eigen::Matrix<X, 3, 3> C;
    Vec<X, 3> n;
    Eigen::Matrix<X, 3, 3> W;  // C^-T C^-1: |y|^2 = r' W r, |y| C^-T u = W r, r = m - n
    X trace;                   // of M and of W
  };

  template <class X>
  static Settled<X> settle(const Vec<X, 9>& xi2) {
    return settle<X>(soft_iron_and_scale<X>(xi2), xi2.template tail<3>());
  }

  template <class U, class X>
  Affine<X, 1, 0> combine(const Prepared<U>& row, const Settled<X>& settled) const {
    const Vec<X, 3> r(row.m[0] - settled.n[0], row.m[1] - settled.n[1], row.m[2] - settled.n[2]);
    if (row.plain) return see(r, settled.W, settled.trace, static_cast<Real<X>>(field_strength));
    Eigen::Matrix<X, 3, 3> C = settled.C;
    for (int i = 0; i < 3; ++i) C(i, i) += X(row.scale[i]);
    const Settled<X> scaled = settle<X>(C, settled.n);
    return see<X, X>(r, scaled.W, scaled.trace,
                     X(row.field_change) + static_cast<Real<X>>(field_strength));
  }

  template <class U, class X>
  Affine<X, 1, 0> at(const Vec<U, 8>& u, const Vec<X, 9>& xi2) const {
    return combine<U, X>(prepare<U>(u), settle<X>(xi2));
  }

  /// C = C_alpha C_lambda (3 x 3): C_alpha symmetric with a unit diagonal, C_lambda = I +
  /// diag(lambda).
  template <class X>
  static Eigen::Matrix<X, 3, 3> soft_iron_and_scale(const Vec<X, 9>& xi2) {
    const X one(Real<X>(1));
    Eigen::Matrix<X, 3, 3> C;
    C << one, xi2[3], xi2[4],  //
        xi2[3], one, xi2[5],   //
        xi2[4], xi2[5], one;
    for (int i = 0; i < 3; ++i) C.col(i) *= one + xi2[i];
    return C;
  }

 private:
  template <class X>
  static Settled<X> settle(const Eigen::Matrix<X, 3, 3>& C, const Vec<X, 3>& n) {
    const Eigen::Matrix<X, 3, 3> G = C.inverse();
    const Eigen::Matrix<X, 3, 3> W = G.transpose() * G;
    return {C, n, W, W.trace()};
  }

  /// r = m - n, F the row's field.
  template <class X, class Strength>
  Affine<X, 1, 0> see(const Vec<X, 3>& r, const Eigen::Matrix<X, 3, 3>& W, const X& trace,
                      const Strength& F) const {
    using std::sqrt;
    const Vec<X, 3> slope = W * r;
    // A reading of n itself has no direction: the floor keeps its derivative finite.
    const auto floor = static_cast<Real<X>>(1e-9 * field_strength);
    const auto variance = static_cast<Real<X>>(noise * noise);
    const X square = r.dot(slope) + floor * floor;
    const X slope_square = slope.squaredNorm() + floor * floor;
    const X length = sqrt(square);
    const X mu = variance / (Real<X>(2) * F) * (trace - slope_square / square);
    Affine<X, 1, 0> z;
    z.b[0] = -(length - F - mu) * length / sqrt(slope_square);
    return z;
  }
};

}  // namespace sepcal
