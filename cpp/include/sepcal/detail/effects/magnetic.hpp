// SPDX-License-Identifier: BSD-3-Clause
// Effects on a magnetometer (Magnetometer): z = C h + n + ..., h the true field in body axes [uT],
// phi = (d - centre)^k - mean of a driver d.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "sepcal/detail/effects/driven.hpp"
#include "sepcal/detail/eigen.hpp"

namespace sepcal::effects {

/// + s phi, on every axis [uT]: the field of a current, a drift, a temperature's bias.
template <Text driver, int power = 1>
using Bias = Follows<"bias", driver, power, "uT", Component<"x", "n_x">, Component<"y", "n_y">,
                     Component<"z", "n_z">>;

inline constexpr std::array true_field{Quantity{"hx", "uT"}, Quantity{"hy", "uT"},
                                       Quantity{"hz", "uT"}};

/// + s phi h, the same s on every axis.
template <Text driver, int power = 1>
struct Scale {
  static constexpr std::array inputs =
      composing::join(true_field, std::array{Quantity{driver.view(), ""}});
  static constexpr std::array linear{Quantity{parameter_name<"scale", driver, power, "s">(), "1"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr bool dual_inputs = true;

  double centre = 0.0;
  double mean = 0.0;

  template <class U, class X>
  Vec<U, 3> columns(const Vec<U, 4>& u, const Vec<X, 0>& /*xi2*/) const {
    return u.template head<3>() * power_of<power>(u[3], centre, mean);
  }
};

/// + s_i phi h_i on axis i.
template <Text driver, int power = 1>
struct AxisScale {
  static constexpr std::array inputs =
      composing::join(true_field, std::array{Quantity{driver.view(), ""}});
  static constexpr std::array linear{
      Quantity{parameter_name<"axis_scale", driver, power, "x">(), "1"},
      Quantity{parameter_name<"axis_scale", driver, power, "y">(), "1"},
      Quantity{parameter_name<"axis_scale", driver, power, "z">(), "1"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr bool dual_inputs = true;

  double centre = 0.0;
  double mean = 0.0;

  template <class U, class X>
  Eigen::Matrix<U, 3, 3> columns(const Vec<U, 4>& u, const Vec<X, 0>& /*xi2*/) const {
    const Vec<U, 3> h = u.template head<3>() * power_of<power>(u[3], centre, mean);
    return h.asDiagonal();
  }
};

/// m_i + d_i h_i^3 + c_i h_i^2.
struct CubicNonlinearity {
  static constexpr std::array inputs = true_field;
  static constexpr std::array linear{
      Quantity{"cubic_nonlinearity.d_x", "1/uT^2"}, Quantity{"cubic_nonlinearity.d_y", "1/uT^2"},
      Quantity{"cubic_nonlinearity.d_z", "1/uT^2"}, Quantity{"cubic_nonlinearity.c_x", "1/uT"},
      Quantity{"cubic_nonlinearity.c_y", "1/uT"},   Quantity{"cubic_nonlinearity.c_z", "1/uT"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr bool dual_inputs = true;

  template <class U, class X>
  Eigen::Matrix<U, 3, 6> columns(const Vec<U, 3>& h, const Vec<X, 0>& /*xi2*/) const {
    Eigen::Matrix<U, 3, 6> G = Eigen::Matrix<U, 3, 6>::Constant(U(Real<U>(0)));
    for (int i = 0; i < 3; ++i) {
      G(i, i) = h[i] * h[i] * h[i];
      G(i, 3 + i) = h[i] * h[i];
    }
    return G;
  }
};

/// + E dh/dt, currents that the turning field induces in the structure; E by rows [s].
struct EddyCurrents {
  static constexpr std::array inputs{Quantity{"hx_dot", "uT/s"}, Quantity{"hy_dot", "uT/s"},
                                     Quantity{"hz_dot", "uT/s"}};
  static constexpr std::array linear{
      Quantity{"eddy_currents.xx", "s"}, Quantity{"eddy_currents.xy", "s"},
      Quantity{"eddy_currents.xz", "s"}, Quantity{"eddy_currents.yx", "s"},
      Quantity{"eddy_currents.yy", "s"}, Quantity{"eddy_currents.yz", "s"},
      Quantity{"eddy_currents.zx", "s"}, Quantity{"eddy_currents.zy", "s"},
      Quantity{"eddy_currents.zz", "s"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr bool dual_inputs = true;

  template <class U, class X>
  Eigen::Matrix<U, 3, 9> columns(const Vec<U, 3>& h_dot, const Vec<X, 0>& /*xi2*/) const {
    Eigen::Matrix<U, 3, 9> G = Eigen::Matrix<U, 3, 9>::Constant(U(Real<U>(0)));
    for (int i = 0; i < 3; ++i) G.row(i).template segment<3>(3 * i) = h_dot.transpose();
    return G;
  }
};

/// The true field is the assumed one turned by delta [rad] about down (a positive delta turns it
/// towards east).
struct FieldDeclination {
  static constexpr int corrected = 3;
  static constexpr std::array inputs =
      composing::join(true_field, std::array{Quantity{"roll", "rad"}, Quantity{"pitch", "rad"}});
  static constexpr std::array nonlinear{Quantity{"field_declination.delta", "rad", -0.35, 0.35}};

  template <class T>
  Vec<T, 3> correct(const Vec<T, 5>& u, const Vec<T, 1>& xi2) const {
    using std::cos;
    using std::sin;
    const Vec<T, 3> h = u.template head<3>();
    const Vec<T, 3> down(-sin(u[4]), sin(u[3]) * cos(u[4]), cos(u[3]) * cos(u[4]));
    const T c = cos(xi2[0]);
    return c * h + sin(xi2[0]) * down.cross(h) + (T(Real<T>(1)) - c) * down.dot(h) * down;
  }
};

/// The attitude is off by small angles about body x and y: h + h x (x, y, 0). A misalignment of the
/// sensor absorbs it.
struct AttitudeBias {
  static constexpr int corrected = 3;
  static constexpr std::array inputs = true_field;
  static constexpr std::array nonlinear{Quantity{"attitude_bias.x", "rad", -0.175, 0.175},
                                        Quantity{"attitude_bias.y", "rad", -0.175, 0.175}};

  template <class T>
  Vec<T, 3> correct(const Vec<T, 3>& h, const Vec<T, 2>& xi2) const {
    return h + h.cross(Vec<T, 3>(xi2[0], xi2[1], T(Real<T>(0))));
  }
};

}  // namespace sepcal::effects

/// Effects on an AttitudeIndependentMagnetometer: those that show in the field's strength.
namespace sepcal::effects::strength {

/// m = C h + n + s phi, on every axis [uT].
template <Text driver, int power = 1>
using Bias = ShiftsEach<"bias", driver, power, "uT", -1, Component<"x", "mx">, Component<"y", "my">,
                        Component<"z", "mz">>;

/// (C + s phi I) h.
template <Text driver, int power = 1>
using Scale = Shifts<"scale", driver, power, "1">;

/// (C + diag(s_i phi)) h.
template <Text driver, int power = 1>
using AxisScale = ShiftsEach<"axis_scale", driver, power, "1", 1, Component<"x", "axis_scale_x">,
                             Component<"y", "axis_scale_y">, Component<"z", "axis_scale_z">>;

}  // namespace sepcal::effects::strength
