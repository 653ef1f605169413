// SPDX-License-Identifier: BSD-3-Clause
// A rigid aircraft in flight, S 6.14 to 6.22, with aerodynamics that are sums of regressors chosen
// at run time. u v w are through the air, in a wind that is constant; axes forward, right, down.
//   (u v w)' = F/m - w x (u v w) + g_body,   (p q r)' = I^-1 (M - w x I w),
//   phi' = p + tan theta (q sin phi + r cos phi),  theta' = q cos phi - r sin phi,
//   psi' = (q sin phi + r cos phi) / cos theta
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/aircraft/geometry.hpp"
#include "sepcal/detail/aircraft/equations.hpp"
#include "sepcal/detail/natural_spline.hpp"
#include "sepcal/detail/rotation.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/models/flight_path.hpp"
#include "sepcal/record.hpp"
#include "sepcal/states/trajectory_model.hpp"

namespace sepcal {

/// Equations as numbers, for a state model to evaluate on any number type.
struct AeroTerms {
  /// What a regressor may be made of beside columns: of the state, never as measured.
  static constexpr std::array<std::string_view, 14> variables{
      "alpha", "beta", "p_hat", "q_hat", "r_hat", "airspeed", "u",
      "v",     "w",    "p",     "q",     "r",     "roll",     "pitch"};

  struct Factor {
    std::size_t variable;  // of variables, then of columns
    int power;
    bool absolute;
  };
  /// One function of a natural spline.
  struct SplineFunction {
    std::size_t variable;
    std::shared_ptr<const SplineBasis> basis;
    int function;
  };
  struct Term {
    std::size_t coefficient;  // of coefficient_names
    std::vector<Factor> factors;
    std::optional<SplineFunction> spline = {};
  };

  std::vector<Term> terms;           // one a parameter
  std::vector<Variable> parameters;  // their names and units
  std::vector<std::string> columns;  // that are no variable of the state
};

/// Throws Error as check_equations() does.
AeroTerms compile_equations(const std::vector<AeroEquation>& equations);

/// With room for `Capacity` aerodynamic parameters: so long are the dual numbers that differentiate
/// it, of which the parameters that aren't in use are zeros.
template <int Capacity>
struct RigidAircraft {
  static constexpr int n_columns = 8;
  static constexpr int n_u = 6 + n_columns;
  enum State { forward, right, below, roll_rate, pitch_rate, yaw_rate, phi, theta, psi };
  enum Input { rho, thrust, mass, airdata_delay, alpha_delay, attitude_delay, first_column };
  enum Output { airspeed, beta, alpha, roll, pitch, yaw, ax, ay, az, p, q, r, vn, ve, vd };

  static constexpr auto inputs = [] {
    std::array<Quantity, n_u> table{
        Quantity{"rho", "kg/m^3"}, Quantity{"thrust", "N", -infinity, infinity, 0.0},
        Quantity{"mass", "kg"},    port("airdata_delay", "s"),
        port("alpha_delay", "s"),  port("attitude_delay", "s")};
    return table;  // name_tables() names the others, and the mass where none is logged
  }();
  static constexpr std::array states{
      Quantity{"u", "m/s"},   Quantity{"v", "m/s"},     Quantity{"w", "m/s"},
      Quantity{"p", "rad/s"}, Quantity{"q", "rad/s"},   Quantity{"r", "rad/s"},
      Quantity{"phi", "rad"}, Quantity{"theta", "rad"}, Quantity{"psi", "rad"}};
  static constexpr std::array outputs{
      Quantity{"airspeed", "m/s"}, Quantity{"beta", "rad"},  Quantity{"alpha", "rad"},
      Quantity{"roll", "rad"},     Quantity{"pitch", "rad"}, Quantity{"yaw", "rad"},
      Quantity{"ax", "m/s^2"},     Quantity{"ay", "m/s^2"},  Quantity{"az", "m/s^2"},
      Quantity{"p", "rad/s"},      Quantity{"q", "rad/s"},   Quantity{"r", "rad/s"},
      Quantity{"vn", "m/s"},       Quantity{"ve", "m/s"},    Quantity{"vd", "m/s"}};
  /// As flight path reconstruction has them: of the first six outputs reading = (1 + lambda) true +
  /// b, of the inertial unit true = reading + b; the wind.
  static constexpr std::array linear{
      Quantity{"lambda_v", "1", -0.5, 0.5},     Quantity{"lambda_beta", "1", -0.9, 0.9},
      Quantity{"lambda_alpha", "1", -0.9, 0.9}, Quantity{"lambda_phi", "1", -0.5, 0.5},
      Quantity{"lambda_theta", "1", -0.5, 0.5}, Quantity{"lambda_psi", "1", -0.5, 0.5},
      Quantity{"b_v", "m/s", -20, 20},          Quantity{"b_beta", "rad", -0.5, 0.5},
      Quantity{"b_alpha", "rad", -0.5, 0.5},    Quantity{"b_phi", "rad", -0.5, 0.5},
      Quantity{"b_theta", "rad", -0.5, 0.5},    Quantity{"b_psi", "rad"},
      Quantity{"b_ax", "m/s^2", -3, 3},         Quantity{"b_ay", "m/s^2", -3, 3},
      Quantity{"b_az", "m/s^2", -3, 3},         Quantity{"b_p", "rad/s", -0.2, 0.2},
      Quantity{"b_q", "rad/s", -0.2, 0.2},      Quantity{"b_r", "rad/s", -0.2, 0.2},
      Quantity{"w_n", "m/s", -100, 100},        Quantity{"w_e", "m/s", -100, 100},
      Quantity{"w_d", "m/s", -100, 100}};
  static constexpr std::array<Quantity, Capacity> nonlinear{};  // name_tables() names those in use
  static constexpr std::array noise{
      Quantity{"u", "m/s^2/sqrt(Hz)"},   Quantity{"v", "m/s^2/sqrt(Hz)"},
      Quantity{"w", "m/s^2/sqrt(Hz)"},   Quantity{"p", "rad/s^2/sqrt(Hz)"},
      Quantity{"q", "rad/s^2/sqrt(Hz)"}, Quantity{"r", "rad/s^2/sqrt(Hz)"}};

  AircraftGeometry geometry;
  AeroTerms aero;
  double gravity = 9.80665;  // m/s^2, at the place of the flight

  static constexpr bool is_scale(int parameter) { return parameter < 6; }
  static constexpr bool acts_on(int parameter, int output) {
    return parameter < 6 ? output == parameter : output == parameter - 6;
  }
  static void check(const Record& record, const TrajectoryOptions& /*options*/) {
    check_flight_path(record);
  }
  void name_tables(StateTables& tables) const {
    tables.inputs[mass].absent = geometry.mass;
    for (std::size_t i = 0; i < aero.columns.size(); ++i) {
      tables.inputs[first_column + i].name = aero.columns[i];
    }
    std::ranges::copy(aero.parameters, tables.nonlinear.begin());
  }

  /// Not a number beyond 85 deg of pitch, where the angles' rates run away.
  template <class U, class X>
  Rate<X, 9> rate(const Vec<X, 9>& x, const Vec<U, n_u>& u, const Vec<X, Capacity>& c) const {
    using std::abs;
    using std::cos;
    using std::sin;
    Rate<X, 9> dx;
    if (!(abs(x[theta]) < steepest_pitch)) return dx;
    const Vec<X, 3> air = x.template head<3>();
    const Vec<X, 3> turn = x.template segment<3>(roll_rate);
    const Motion<X> motion = motion_of(x, u, c);
    const X s = sin(x[phi]);
    const X t = cos(x[phi]);
    const X s_theta = sin(x[theta]);
    const X c_theta = cos(x[theta]);
    const Vec<X, 3> down(-s_theta, s * c_theta, t * c_theta);
    dx.template head<3>() = motion.specific_force - turn.cross(air) + X(gravity) * down;
    dx.template segment<3>(roll_rate) = motion.turn_rate;
    dx[theta] = turn[1] * t - turn[2] * s;
    dx[psi] = (turn[1] * s + turn[2] * t) / c_theta;
    dx[phi] = turn[0] + s_theta * dx[psi];
    return dx;
  }

  /// Forces and the velocity over the ground are the inertial unit's, the flow is the vane's; what
  /// is late reads the state of its delay ago, to first order, and alpha that of both its delays.
  template <class U, class X>
  Affine<X, 15, 21> at(const Vec<X, 9>& x, const Vec<U, n_u>& u, const Vec<X, Capacity>& c) const {
    using std::asin;
    using std::atan2;
    using std::sqrt;
    const Vec<X, 3> turn = x.template segment<3>(roll_rate);
    const Vec<X, 3> imu = (geometry.imu - geometry.cg).template cast<X>();
    const Vec<X, 3> vane = (geometry.vane - geometry.cg).template cast<X>();
    const Motion<X> motion = motion_of(x, u, c);
    const auto at_vane = [&](const Vec<X, 9>& state) -> Vec<X, 3> {
      return state.template head<3>() + state.template segment<3>(roll_rate).cross(vane);
    };
    const Vec<X, 3> air = at_vane(ago(u[airdata_delay], x, u, c));
    const Vec<X, 3> at_alpha =
        u[alpha_delay] == U(0.0) ? air : at_vane(ago(u[airdata_delay] + u[alpha_delay], x, u, c));
    Affine<X, 15, 21> z{.A = Eigen::Matrix<X, 15, 21>::Zero()};
    z.b[airspeed] = sqrt(air.dot(air));
    z.b[beta] = asin(air[1] / z.b[airspeed]);
    z.b[alpha] = atan2(at_alpha[2], at_alpha[0]);
    z.b.template segment<3>(roll) = ago(u[attitude_delay], x, u, c).template segment<3>(phi);
    z.b.template segment<3>(ax) =
        motion.specific_force + motion.turn_rate.cross(imu) + turn.cross(turn.cross(imu));
    z.b.template segment<3>(p) = turn;
    z.b.template segment<3>(vn) =
        body_to_ned(x[phi], x[theta], x[psi]) * Vec<X, 3>(x.template head<3>() + turn.cross(imu));
    for (int j = 0; j < 6; ++j) z.A(j, j) = z.b[j];
    for (int j = 0; j < 15; ++j) z.A(j, 6 + j) = X(j >= ax && j <= r ? -1.0 : 1.0);
    return z;
  }

  /// From the first readings.
  Vec<double, 9> start(const Vec<double, n_u>& /*u*/, const Vec<double, 15>& z) const {
    const Eigen::Vector3d vane = geometry.vane - geometry.cg;
    Vec<double, 15> known = z;
    for (int j = 0; j < 15; ++j) {
      if (!std::isfinite(z[j])) known[j] = j == airspeed ? 1.0 : 0.0;
    }
    const double a = known[alpha];
    const double s = known[beta];
    Vec<double, 9> x;
    x.template segment<3>(roll_rate) = known.template segment<3>(p);
    x.template segment<3>(phi) = known.template segment<3>(roll);
    x.template head<3>() = known[airspeed] * Eigen::Vector3d(std::cos(a) * std::cos(s), std::sin(s),
                                                             std::sin(a) * std::cos(s)) -
                           Eigen::Vector3d(x.template segment<3>(roll_rate)).cross(vane);
    return x;
  }

 private:
  /// The state some time ago.
  template <class U, class X>
  Vec<X, 9> ago(const U& delay, const Vec<X, 9>& x, const Vec<U, n_u>& u,
                const Vec<X, Capacity>& c) const {
    if (delay == U(0.0)) return x;
    return x - X(delay) * rate(x, u, c);
  }

  template <class X>
  struct Motion {
    Vec<X, 3> specific_force;  // at the centre of gravity, m/s^2
    Vec<X, 3> turn_rate;       // (p q r)', rad/s^2
  };

  template <class U, class X>
  Motion<X> motion_of(const Vec<X, 9>& x, const Vec<U, n_u>& u, const Vec<X, Capacity>& c) const {
    using std::sqrt;
    const Inertia& I = geometry.inertia;
    const Vec<X, 3> air = x.template head<3>();
    const Vec<X, 3> turn = x.template segment<3>(roll_rate);
    const X V = sqrt(air.dot(air));
    const Vec<X, 6> C = coefficients(x, V, u, c);
    const X force = 0.5 * u[rho] * geometry.area * V * V;  // qbar S
    Motion<X> motion;
    motion.specific_force = force / u[mass] * C.template head<3>();
    motion.specific_force[0] += u[thrust] / u[mass];
    const Vec<X, 3> momentum(I.Ix * turn[0] - I.Ixz * turn[2], I.Iy * turn[1],
                             I.Iz * turn[2] - I.Ixz * turn[0]);
    const Vec<X, 3> arms(X(geometry.span), X(geometry.chord), X(geometry.span));
    const Vec<X, 3> moment = force * arms.cwiseProduct(C.template tail<3>()) - turn.cross(momentum);
    const double determinant = I.Ix * I.Iz - I.Ixz * I.Ixz;
    motion.turn_rate[0] = (I.Iz * moment[0] + I.Ixz * moment[2]) / determinant;
    motion.turn_rate[1] = moment[1] / I.Iy;
    motion.turn_rate[2] = (I.Ixz * moment[0] + I.Ix * moment[2]) / determinant;
    return motion;
  }

  template <class U, class X>
  Vec<X, 6> coefficients(const Vec<X, 9>& x, const X& V, const Vec<U, n_u>& u,
                         const Vec<X, Capacity>& c) const {
    using std::abs;
    using std::asin;
    using std::atan2;
    const bool twice = geometry.rate_reference == RateReference::chord_per_twice_speed;
    const X half = 0.5 / V;
    std::array<X, AeroTerms::variables.size() + n_columns> values;
    values[0] = atan2(x[below], x[forward]);
    values[1] = asin(x[right] / V);
    values[2] = geometry.span * half * x[roll_rate];
    values[3] = geometry.chord * (twice ? 1.0 : 2.0) * half * x[pitch_rate];
    values[4] = geometry.span * half * x[yaw_rate];
    values[5] = V;
    for (std::size_t i = 0; i < 8; ++i) values[6 + i] = x[static_cast<Eigen::Index>(i)];
    for (int i = 0; i < n_columns; ++i) {
      values[AeroTerms::variables.size() + static_cast<std::size_t>(i)] = X(u[first_column + i]);
    }
    Vec<X, 6> C = Vec<X, 6>::Zero();
    for (std::size_t k = 0; k < aero.terms.size(); ++k) {
      X product = c[static_cast<Eigen::Index>(k)];
      for (const AeroTerms::Factor& factor : aero.terms[k].factors) {
        const X& value = values[factor.variable];
        for (int i = 0; i < factor.power; ++i) product *= factor.absolute ? X(abs(value)) : value;
      }
      if (const auto& spline = aero.terms[k].spline) {
        product *= spline->basis->value(spline->function, values[spline->variable]);
      }
      C[static_cast<Eigen::Index>(aero.terms[k].coefficient)] += product;
    }
    return C;
  }
};

/// Throws Error for more than 40 regressors or 8 columns among them.
void check_room(const AeroTerms& aero);

/// A trajectory of a RigidAircraft with a regressor more, along the same record. Throws Error for
/// another model, a regressor of a column that the record doesn't have, and one too many.
std::shared_ptr<const BlockModel> with_regressor(const BlockModel& model,
                                                 const std::string& coefficient,
                                                 const std::string& regressor,
                                                 const Record& record);

/// The same with a natural spline of what a regressor may be made of, linear beyond its knots: the
/// effect "Cm[spline(alpha,5)]" with parameters "Cm[spline(alpha,5)].s_2" ..., the values at the
/// knots but the first, and without the last where the coefficient has a straight line of its own.
/// Throws Error as with_regressor() does, and for fewer than three knots.
std::shared_ptr<const BlockModel> with_spline(const BlockModel& model,
                                              const std::string& coefficient,
                                              const std::string& variable,
                                              const std::vector<double>& knots,
                                              const Record& record);

/// Those that are compiled; aircraft_model() takes the smallest that has room. With the nine states
/// their dual numbers are of odd length: even ones are padded to the width of registers, and A then
/// outgrows the stack.
extern template class TrajectoryModel<RigidAircraft<16>>;
extern template class TrajectoryModel<RigidAircraft<24>>;
extern template class TrajectoryModel<RigidAircraft<40>>;

}  // namespace sepcal
