// SPDX-License-Identifier: BSD-3-Clause
// Effects on an air-data probe (FiveHoleProbe). With phi = (d - centre)^k - mean of a driver d, v
// the airspeed as read and V the corrected one.
#pragma once

#include <array>
#include <cmath>

#include "sepcal/detail/effects/driven.hpp"
#include "sepcal/detail/rotation.hpp"

namespace sepcal::effects {

/// W + s phi, north and east [m/s].
template <Text driver, int power = 1>
using Wind = Follows<"wind", driver, power, "m/s", Component<"n", "w_n">, Component<"e", "w_e">>;

/// V + s phi v.
template <Text driver, int power = 1>
using AirspeedScale = Follows<"airspeed_scale", driver, power, "1", Component<"s", "lambda_va">>;

/// V + s phi [m/s].
template <Text driver, int power = 1>
using AirspeedBias = Follows<"airspeed_bias", driver, power, "m/s", Component<"s", "b_va">>;

/// (pt - ps) + s phi [Pa] where the airspeed is read; the flow angles as they are.
template <Text driver, int power = 1>
using PressureOffset = Shifts<"pressure_offset", driver, power, "Pa">;

/// (pt - ps) + s [Pa] there: the zero of the pressure difference is off.
using PressureZero = ShiftsAlways<"pressure_offset", "Pa">;

/// alpha + s phi, alpha as read [rad].
template <Text driver, int power = 1>
using AlphaOffset = Shifts<"alpha_offset", driver, power, "rad">;

/// beta + s phi, beta as read [rad].
template <Text driver, int power = 1>
using BetaOffset = Shifts<"beta_offset", driver, power, "rad">;

/// The navigation's heading is delta [rad] more than the true one.
struct HeadingBias {
  static constexpr int corrected = 1;
  static constexpr std::array inputs{Quantity{"yaw", "rad"}};
  static constexpr std::array nonlinear{Quantity{"heading_bias.delta", "rad", -0.35, 0.35}};

  template <class T>
  Vec<T, 1> correct(const Vec<T, 1>& u, const Vec<T, 1>& xi2) const {
    return u - xi2;
  }
};

/// The probe sits dr [m, body axes] farther than the lever arm says: -C_b^n (w x dr).
struct LeverArm {
  static constexpr std::array inputs{Quantity{"roll", "rad"}, Quantity{"pitch", "rad"},
                                     Quantity{"yaw", "rad"},  Quantity{"p", "rad/s"},
                                     Quantity{"q", "rad/s"},  Quantity{"r", "rad/s"}};
  static constexpr std::array linear{Quantity{"lever_arm.x", "m"}, Quantity{"lever_arm.y", "m"},
                                     Quantity{"lever_arm.z", "m"}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  static constexpr bool dual_inputs = true;

  template <class U, class X>
  Eigen::Matrix<U, 3, 3> columns(const Vec<U, 6>& u, const Vec<X, 0>& /*xi2*/) const {
    Eigen::Matrix<U, 3, 3> cross;
    const U zero(Real<U>(0));
    cross << zero, -u[5], u[4],  //
        u[5], zero, -u[3],       //
        -u[4], u[3], zero;
    return -(body_to_ned<U>(u[0], u[1], u[2]) * cross);
  }
};

/// The probe, its arm with it, is turned against the vehicle by small angles about body y and z:
/// C_b^n R_z(yaw) R_y(pitch) stands for C_b^n. b_alpha and b_beta absorb it.
struct MountingError {
  static constexpr int corrected = 3;
  static constexpr std::array inputs{Quantity{"roll", "rad"}, Quantity{"pitch", "rad"},
                                     Quantity{"yaw", "rad"}};
  static constexpr std::array nonlinear{Quantity{"mounting_error.pitch", "rad", -0.175, 0.175},
                                        Quantity{"mounting_error.yaw", "rad", -0.175, 0.175}};

  template <class T>
  Vec<T, 3> correct(const Vec<T, 3>& u, const Vec<T, 2>& xi2) const {
    using std::asin;
    using std::atan2;
    const T zero(Real<T>(0));
    const Eigen::Matrix<T, 3, 3> C =
        body_to_ned<T>(u[0], u[1], u[2]) * body_to_ned<T>(zero, xi2[0], xi2[1]);
    return {atan2(C(2, 1), C(2, 2)), -asin(C(2, 0)), atan2(C(1, 0), C(0, 0))};
  }
};

}  // namespace sepcal::effects

/// Effects on a Pitot-static tube (PitotStatic): what the tube makes of the air. Its pressure's
/// offset is PressureOffset, a constant one PressureZero.
namespace sepcal::effects::tube {

/// V = (1 + s phi) V_met + ...
template <Text driver, int power = 1>
using AirspeedScale = Shifts<"airspeed_scale", driver, power, "1">;

/// ... + s phi [m/s].
template <Text driver, int power = 1>
using AirspeedBias = Shifts<"airspeed_bias", driver, power, "m/s">;

}  // namespace sepcal::effects::tube
