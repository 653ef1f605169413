// SPDX-License-Identifier: BSD-3-Clause
// Flight path reconstruction, or data compatibility (Sun & Gebre-Egziabher, B4-B9): the states
// follow from the inertial unit, true = measured + b (B5), and what air data and attitude sensors
// read has scales and biases. Axes forward, right, down; ax ay az are specific forces: level flight
// reads az = -9.81.
//   (u v w)' = a - w x (u v w) + g_body,  phi' = p + tan theta (q sin phi + r cos phi),
//   theta' = q cos phi - r sin phi,  psi' = (q sin phi + r cos phi) / cos theta,
//   (x y z)' = C_b^n (u v w) + W
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

#include "sepcal/detail/lanewise.hpp"
#include "sepcal/detail/rotation.hpp"
#include "sepcal/states/state_model.hpp"

namespace sepcal {

class Record;
struct TrajectoryOptions;

/// Throws Error for rates or angles in degrees, and a vertical specific force that level flight
/// doesn't read as az = -9.81 m/s^2: the other sign, g, gravity taken out.
void check_body_axes(const Record& record);

/// Throws Error as check_body_axes() does, and for a pitch beyond 85 deg.
void check_flight_path(const Record& record);

inline constexpr double steepest_pitch = 85.0 * std::numbers::pi / 180.0;  // rad

/// Relative to the air and to a wind that is constant. (x y z) are positions, with `Position`; the
/// wind is nonlinear then, as it moves them, and linear otherwise.
template <bool Position>
struct FlightPathModel {
  static constexpr int n_x = Position ? 9 : 6;
  static constexpr int n_z = Position ? 12 : 9;
  static constexpr int n_1 = Position ? 12 : 15;
  static constexpr int n_p = Position ? 9 : 6;
  enum State { forward, right, below, phi, theta, psi };  // u v w and the attitude
  static constexpr int n_u = 16;
  enum Input {
    ax,
    ay,
    az,
    roll_rate,
    pitch_rate,
    yaw_rate,
    gust,
    vane_shift = gust + 3,
    airdata_delay = vane_shift + 3,
    alpha_delay,
    attitude_delay,
    velocity_delay
  };
  enum Output { airspeed, beta, alpha, roll, pitch, yaw, vn, ve, vd, north, east, down };

  /// What the inertial unit reads; then, zero unless an effect drives them, how much the wind
  /// differs from the constant one, and the vane from where it is said to be, and how late the
  /// other sensors are: alpha by both of its delays.
  static constexpr std::array inputs{
      Quantity{"ax", "m/s^2"},      Quantity{"ay", "m/s^2"},      Quantity{"az", "m/s^2"},
      Quantity{"p", "rad/s"},       Quantity{"q", "rad/s"},       Quantity{"r", "rad/s"},
      port("wind_change_n", "m/s"), port("wind_change_e", "m/s"), port("wind_change_d", "m/s"),
      port("vane_shift_x", "m"),    port("vane_shift_y", "m"),    port("vane_shift_z", "m"),
      port("airdata_delay", "s"),   port("alpha_delay", "s"),     port("attitude_delay", "s"),
      port("velocity_delay", "s")};
  static constexpr int readings = 6;  // of these inputs

 private:
  /// The first N of a table.
  template <int N, std::size_t Size>
  static constexpr std::array<Quantity, N> first(const std::array<Quantity, Size>& table) {
    std::array<Quantity, N> result{};
    std::copy_n(table.begin(), N, result.begin());
    return result;
  }

 public:
  static constexpr auto states = first<n_x>(
      std::array{Quantity{"u", "m/s"}, Quantity{"v", "m/s"}, Quantity{"w", "m/s"},
                 Quantity{"phi", "rad"}, Quantity{"theta", "rad"}, Quantity{"psi", "rad"},
                 Quantity{"x", "m"}, Quantity{"y", "m"}, Quantity{"z", "m"}});
  static constexpr auto outputs = first<n_z>(
      std::array{Quantity{"airspeed", "m/s"}, Quantity{"beta", "rad"}, Quantity{"alpha", "rad"},
                 Quantity{"roll", "rad"}, Quantity{"pitch", "rad"}, Quantity{"yaw", "rad"},
                 Quantity{"vn", "m/s"}, Quantity{"ve", "m/s"}, Quantity{"vd", "m/s"},
                 Quantity{"north", "m"}, Quantity{"east", "m"}, Quantity{"down", "m"}});
  /// b_psi is as free as psi_0 is, for which it can't be told: a yaw that turns on has no bounds.
  static constexpr auto linear = first<n_1>(
      std::array{Quantity{"lambda_v", "1", -0.5, 0.5}, Quantity{"lambda_beta", "1", -0.9, 0.9},
                 Quantity{"lambda_alpha", "1", -0.9, 0.9}, Quantity{"lambda_phi", "1", -0.5, 0.5},
                 Quantity{"lambda_theta", "1", -0.5, 0.5}, Quantity{"lambda_psi", "1", -0.5, 0.5},
                 Quantity{"b_v", "m/s", -20, 20}, Quantity{"b_beta", "rad", -0.5, 0.5},
                 Quantity{"b_alpha", "rad", -0.5, 0.5}, Quantity{"b_phi", "rad", -0.5, 0.5},
                 Quantity{"b_theta", "rad", -0.5, 0.5}, Quantity{"b_psi", "rad"},
                 Quantity{"w_n", "m/s", -100, 100}, Quantity{"w_e", "m/s", -100, 100},
                 Quantity{"w_d", "m/s", -100, 100}});
  static constexpr auto nonlinear =
      first<n_p>(std::array{Quantity{"b_ax", "m/s^2", -3, 3}, Quantity{"b_ay", "m/s^2", -3, 3},
                            Quantity{"b_az", "m/s^2", -3, 3}, Quantity{"b_p", "rad/s", -0.2, 0.2},
                            Quantity{"b_q", "rad/s", -0.2, 0.2},
                            Quantity{"b_r", "rad/s", -0.2, 0.2}, Quantity{"w_n", "m/s", -100, 100},
                            Quantity{"w_e", "m/s", -100, 100}, Quantity{"w_d", "m/s", -100, 100}});
  static constexpr std::array noise{
      Quantity{"ax", "m/s^2/sqrt(Hz)"}, Quantity{"ay", "m/s^2/sqrt(Hz)"},
      Quantity{"az", "m/s^2/sqrt(Hz)"}, Quantity{"p", "rad/s/sqrt(Hz)"},
      Quantity{"q", "rad/s/sqrt(Hz)"},  Quantity{"r", "rad/s/sqrt(Hz)"}};

  /// Hardly told from others on most records: hold them at zero (FitOptions::fixed) unless there is
  /// a reason. b_psi never is: psi_0 takes its place.
  static constexpr std::array<std::string_view, 3> held_at_zero{"b_v", "b_alpha", "b_psi"};

  double gravity = 9.80665;                        // m/s^2, at the place of the flight
  Eigen::Vector3d vane = Eigen::Vector3d::Zero();  // from the inertial unit, body axes, m

  static constexpr bool is_scale(int parameter) { return parameter < 6; }
  static constexpr bool acts_on(int parameter, int output) {
    return parameter < 12 ? parameter % 6 == output : output == vn + parameter - 12;
  }
  static void check(const Record& record, const TrajectoryOptions& /*options*/) {
    check_flight_path(record);
  }

  /// B5. Not a number beyond 85 deg of pitch, where the angles' rates run away.
  template <class U, class X>
  Rate<X, n_x> rate(const Vec<X, n_x>& x, const Vec<U, n_u>& u, const Vec<X, n_p>& p) const {
    using std::abs;
    using std::cos;
    using std::sin;
    Rate<X, n_x> dx;
    if (!(abs(x[theta]) < static_cast<Real<X>>(steepest_pitch))) return dx;
    const auto g = static_cast<Real<X>>(gravity);
    const Vec<X, 3> a(u[ax] + p[ax], u[ay] + p[ay], u[az] + p[az]);
    const Vec<X, 3> turn(u[roll_rate] + p[roll_rate], u[pitch_rate] + p[pitch_rate],
                         u[yaw_rate] + p[yaw_rate]);
    const X s_phi = sin(x[phi]);
    const X c_phi = cos(x[phi]);
    const X s_theta = sin(x[theta]);
    const X c_theta = cos(x[theta]);
    dx[forward] = a[0] - turn[1] * x[below] + turn[2] * x[right] - g * s_theta;
    dx[right] = a[1] - turn[2] * x[forward] + turn[0] * x[below] + g * s_phi * c_theta;
    dx[below] = a[2] - turn[0] * x[right] + turn[1] * x[forward] + g * c_phi * c_theta;
    dx[theta] = turn[1] * c_phi - turn[2] * s_phi;
    dx[psi] = (turn[1] * s_phi + turn[2] * c_phi) / c_theta;
    dx[phi] = turn[0] + s_theta * dx[psi];
    if constexpr (Position) {
      dx.template tail<3>() = over_ground(body_to_ned(x[phi], x[theta], x[psi]), x, p);
    }
    return dx;
  }

  /// The readings: (1 + lambda) true + b. u v w are relative to the air of the constant wind, as
  /// the inertial unit has them; the air data see the wind that there is. What is late reads the
  /// state of its delay ago, to first order.
  template <class U, class X>
  Affine<X, n_z, n_1> at(const Vec<X, n_x>& x, const Vec<U, n_u>& u, const Vec<X, n_p>& p) const {
    using std::asin;
    using std::atan2;
    using std::sqrt;
    const Vec<X, 3> turn(u[roll_rate] + p[roll_rate], u[pitch_rate] + p[pitch_rate],
                         u[yaw_rate] + p[yaw_rate]);
    Vec<X, 3> change;
    Vec<X, 3> arm;
    for (int i = 0; i < 3; ++i) {
      change[i] = X(u[gust + i]);
      arm[i] = X(static_cast<Real<X>>(vane[i]) + u[vane_shift + i]);
    }
    const auto at_vane = [&](const Vec<X, n_x>& state) -> Vec<X, 3> {
      return state.template head<3>() + turn.cross(arm) -
             body_to_ned(state[phi], state[theta], state[psi]).transpose() * change;
    };
    const Vec<X, n_x> by_air = ago(u[airdata_delay], x, u, p);
    const Vec<X, n_x> by_velocity = ago(u[velocity_delay], x, u, p);
    const Vec<X, 3> air = at_vane(by_air);
    const Vec<X, 3> at_alpha = u[alpha_delay] == U(Real<U>(0))
                                   ? air
                                   : at_vane(ago(u[airdata_delay] + u[alpha_delay], x, u, p));
    Affine<X, n_z, n_1> z{.A = Eigen::Matrix<X, n_z, n_1>::Zero()};
    z.b[airspeed] = sqrt(air.dot(air));
    z.b[beta] = asin(air[1] / z.b[airspeed]);
    z.b[alpha] = atan2(at_alpha[2], at_alpha[0]);
    z.b.template segment<3>(roll) = ago(u[attitude_delay], x, u, p).template segment<3>(phi);
    for (int j = 0; j < 6; ++j) {
      z.A(j, j) = z.b[j];
      z.A(j, 6 + j) = X(Real<X>(1));
    }
    z.b.template segment<3>(vn) = over_ground(
        body_to_ned(by_velocity[phi], by_velocity[theta], by_velocity[psi]), by_velocity, p);
    if constexpr (Position) {
      z.b.template tail<3>() = by_velocity.template tail<3>();
    } else {
      z.A.template block<3, 3>(vn, 12).setIdentity();
    }
    return z;
  }

  /// The inertial unit's noise enters where its readings do.
  template <class U, class X>
  Eigen::Matrix<X, n_x, 6> noise_input(const Vec<X, n_x>& x, const Vec<U, n_u>& /*u*/,
                                       const Vec<X, n_p>& /*p*/) const {
    using std::cos;
    using std::sin;
    using std::tan;
    const X s = sin(x[phi]);
    const X c = cos(x[phi]);
    const X t = tan(x[theta]);
    const X d = cos(x[theta]);
    const X o(Real<X>(0));
    Eigen::Matrix<X, n_x, 6> G = Eigen::Matrix<X, n_x, 6>::Zero();
    G.template topLeftCorner<3, 3>().setIdentity();
    G.template block<3, 3>(0, 3) << o, -x[below], x[right], x[below], o, -x[forward], -x[right],
        x[forward], o;
    G.template block<3, 3>(3, 3) << X(Real<X>(1)), s * t, c * t, o, c, -s, o, s / d, c / d;
    return G;
  }

  /// u v w from airspeed and flow angles, the attitude as read, the position as read.
  Vec<double, n_x> start(const Vec<double, n_u>& /*u*/, const Vec<double, n_z>& z) const {
    const auto known = [](double reading, double otherwise) {
      return std::isfinite(reading) ? reading : otherwise;
    };
    const double ground = std::hypot(z[vn], z[ve], z[vd]);
    const double speed = known(z[airspeed], known(ground, 1.0));
    const double a = known(z[alpha], 0.0);
    const double s = known(z[beta], 0.0);
    Vec<double, n_x> x = Vec<double, n_x>::Zero();
    x.template head<3>() =
        speed * Eigen::Vector3d(std::cos(a) * std::cos(s), std::sin(s), std::sin(a) * std::cos(s));
    x[phi] = known(z[roll], 0.0);
    x[theta] = known(z[pitch], 0.0);
    x[psi] = known(z[yaw], known(std::atan2(z[ve], z[vn]), 0.0));
    if constexpr (Position) {
      for (int i = 0; i < 3; ++i) x[6 + i] = known(z[north + i], 0.0);
    }
    return x;
  }

 private:
  /// The state some time ago.
  template <class U, class X>
  Vec<X, n_x> ago(const U& delay, const Vec<X, n_x>& x, const Vec<U, n_u>& u,
                  const Vec<X, n_p>& p) const {
    if (delay == U(Real<U>(0))) return x;
    return x - X(delay) * rate(x, u, p);
  }

  /// The velocity over the ground; without the wind where that is linear.
  template <class X>
  static Vec<X, 3> over_ground(const Eigen::Matrix<X, 3, 3>& to_ned, const Vec<X, n_x>& x,
                               const Vec<X, n_p>& p) {
    Vec<X, 3> air = to_ned * Vec<X, 3>(x.template head<3>());
    if constexpr (Position) air += p.template tail<3>();
    return air;
  }
};

using FlightPath = FlightPathModel<false>;
using FlightPathWithPosition = FlightPathModel<true>;

}  // namespace sepcal
