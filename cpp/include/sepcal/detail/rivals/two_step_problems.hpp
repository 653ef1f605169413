// SPDX-License-Identifier: BSD-3-Clause
// Problems in the form that the Haupt/Kasdin estimator takes: the paper's first scalar example, in
// the paper's five states and in the three that it has, and a magnetometer of which only the
// field's strength is known.
#pragma once

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <utility>

#include "sepcal/detail/model.hpp"
#include "sepcal/detail/quantity.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"

namespace sepcal::rivals {

/// z = (1 + a) cos(eta + b) + c in y = [a cos b, a sin b, cos b, sin b, c] (Eq. 28; its H lacks the
/// column of c). Columns 1 and 3, and 2 and 4, of H are the same: of rank three, whatever the rows.
struct ExampleInFiveStates {
  static constexpr std::array inputs{Quantity{"eta", "rad"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array states{Quantity{"a cos b", "1"}, Quantity{"a sin b", "1"},
                                     Quantity{"cos b", "1"}, Quantity{"sin b", "1"},
                                     Quantity{"level", "1"}};
  static constexpr std::array parameters{Quantity{"a", "1"}, Quantity{"c", "1"},
                                         Quantity{"b", "rad"}};

  static Affine<double, 1, 5> rows(const Vec<double, 1>& u) {
    Affine<double, 1, 5> z;
    const double cosine = std::cos(u[0]);
    const double sine = std::sin(u[0]);
    z.A << cosine, -sine, cosine, -sine, 1.0;
    z.b << 0.0;
    return z;
  }

  template <class X>
  static Vec<X, 5> states_at(const Vec<X, 3>& xi) {
    using std::cos;
    using std::sin;
    Vec<X, 5> y;
    y << xi[0] * cos(xi[2]), xi[0] * sin(xi[2]), cos(xi[2]), sin(xi[2]), xi[1];
    return y;
  }
};

/// The same in y = [(1 + a) cos b, (1 + a) sin b, c], which the measurements determine.
struct ExampleInThreeStates {
  static constexpr std::array inputs{Quantity{"eta", "rad"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array states{Quantity{"(1 + a) cos b", "1"}, Quantity{"(1 + a) sin b", "1"},
                                     Quantity{"level", "1"}};
  static constexpr std::array parameters{Quantity{"a", "1"}, Quantity{"c", "1"},
                                         Quantity{"b", "rad"}};

  static Affine<double, 1, 3> rows(const Vec<double, 1>& u) {
    Affine<double, 1, 3> z;
    z.A << std::cos(u[0]), -std::sin(u[0]), 1.0;
    z.b << 0.0;
    return z;
  }

  template <class X>
  static Vec<X, 3> states_at(const Vec<X, 3>& xi) {
    using std::cos;
    using std::sin;
    Vec<X, 3> y;
    y << (1.0 + xi[0]) * cos(xi[2]), (1.0 + xi[0]) * sin(xi[2]), xi[1];
    return y;
  }
};

/// Q = (C C')^-1 and Q n of AttitudeIndependentMagnetometer's parameters.
template <class X>
std::pair<Eigen::Matrix<X, 3, 3>, Vec<X, 3>> quadric_of(const Vec<X, 9>& xi) {
  const Eigen::Matrix<X, 3, 3> C = AttitudeIndependentMagnetometer::soft_iron_and_scale<X>(xi);
  const Eigen::Matrix<X, 3, 3> inverse = C.inverse();
  const Eigen::Matrix<X, 3, 3> Q = inverse.transpose() * inverse;
  return {Q, Q * xi.template tail<3>()};
}

/// Readings m = C h + n, |h| = F, lie on (m - n)' Q (m - n) = F^2, Q = (C C')^-1: divided by Q_xx,
///   0 = m_x^2 + [m_y^2, m_z^2, 2 m_x m_y, 2 m_x m_z, 2 m_y m_z, -2 m', 1] y + v
/// (Gebre-Egziabher, Elkaim, Powell & Parkinson, 2001, there of equal axes without cross terms).
/// Parameters as AttitudeIndependentMagnetometer's. H is made of readings and has their noise: the
/// estimate is not consistent. The output `quadric` is zero in every row.
struct MagnetometerInNineStates {
  static constexpr std::array inputs{Quantity{"mx", "uT"}, Quantity{"my", "uT"},
                                     Quantity{"mz", "uT"}};
  static constexpr std::array outputs{Quantity{"quadric", "uT^2", -infinity, infinity, 0.0}};
  static constexpr std::array states{
      Quantity{"q_yy", "1"}, Quantity{"q_zz", "1"}, Quantity{"q_xy", "1"},
      Quantity{"q_xz", "1"}, Quantity{"q_yz", "1"}, Quantity{"q_x", "uT"},
      Quantity{"q_y", "uT"}, Quantity{"q_z", "uT"}, Quantity{"q_0", "uT^2"}};
  static constexpr auto parameters = AttitudeIndependentMagnetometer::nonlinear;

  double field_strength;  // F [uT]

  static Affine<double, 1, 9> rows(const Vec<double, 3>& m) {
    Affine<double, 1, 9> z;
    z.A << m[1] * m[1], m[2] * m[2], 2.0 * m[0] * m[1], 2.0 * m[0] * m[2], 2.0 * m[1] * m[2],
        -2.0 * m[0], -2.0 * m[1], -2.0 * m[2], 1.0;
    z.b << m[0] * m[0];
    return z;
  }

  template <class X>
  Vec<X, 9> states_at(const Vec<X, 9>& xi) const {
    const auto [Q, Qn] = quadric_of(xi);
    const Vec<X, 3> n = xi.template tail<3>();
    Vec<X, 9> y;
    y << Q(1, 1), Q(2, 2), Q(0, 1), Q(0, 2), Q(1, 2), Qn[0], Qn[1], Qn[2],
        n.dot(Qn) - field_strength * field_strength;
    return y / Q(0, 0);
  }
};

}  // namespace sepcal::rivals
