// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/flown_aircraft.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "sepcal/error.hpp"
#include "simulation/simulated_flight.hpp"
#include "simulation/simulated_noise.hpp"

namespace sepcal::simulation {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double integration_step = 0.0025;  // s

struct ManeuverFlown {
  std::string_view label;
  double begin;  // s
  double end;
};

constexpr std::array maneuvers_flown{
    ManeuverFlown{"elevator_3211", 1.0, 6.0}, ManeuverFlown{"elevator_1123", 7.0, 12.0},
    ManeuverFlown{"aileron", 14.0, 19.0}, ManeuverFlown{"rudder", 20.0, 26.0},
    ManeuverFlown{"sweep", 28.0, 38.0}};

/// 1 from `begin` to `end`, s, over edges that a surface takes 0.1 s for.
double surface_pulse(double t, double begin, double end) {
  constexpr double edge = 0.1;  // s
  return std::clamp((t - begin) / edge, 0.0, 1.0) - std::clamp((t - end) / edge, 0.0, 1.0);
}

double step_3211(double t) {
  return surface_pulse(t, 0.0, 1.2) - surface_pulse(t, 1.2, 2.0) + surface_pulse(t, 2.0, 2.4) -
         surface_pulse(t, 2.4, 2.8);
}

/// Both ways, one after the other.
double surface_doublets(double t, double width) {
  return surface_pulse(t, 0.0, width) - 2.0 * surface_pulse(t, width, 2.0 * width) +
         surface_pulse(t, 2.0 * width, 3.0 * width);
}

/// Elevator, aileron, rudder, rad.
Vector3d surfaces_moved(double t) {
  const double sweep = std::clamp(t - 28.0, 0.0, 10.0);
  return {0.05 * (step_3211(t - 1.0) - step_3211(t - 7.0)) +
              0.03 * std::sin(2.0 * pi * (0.2 + 0.1 * sweep) * sweep),
          0.08 * surface_doublets(t - 14.0, 0.8) + 0.03 * std::sin(1.9 * sweep),
          0.08 * surface_doublets(t - 20.0, 1.2) + 0.03 * std::sin(2.7 * sweep)};
}

FlightState moved(const FlightState& from, const FlightState& change, double dt) {
  return {from.velocity + dt * change.velocity, from.quaternion + dt * change.quaternion,
          from.rates + dt * change.rates, from.altitude + dt * change.altitude};
}

Quaterniond turn_of(const FlightState& state) {
  const Vector4d& e = state.quaternion;
  return Quaterniond(e[0], e[1], e[2], e[3]).normalized();
}

constexpr std::array aero_names{"CX", "CY", "CZ", "Cl", "Cm", "Cn"};
constexpr std::array aero_regressors{"0", "alpha", "alpha^2",  "beta",    "p",
                                     "q", "r",     "elevator", "aileron", "rudder"};

/// A first-order process in steps of `dt`, whose standard deviation is `size`.
void stir(Vector3d& gust, double size, double correlation, RandomNumbers& random) {
  for (double& part : gust) {
    const double fresh = random.draw_normal();
    part = correlation * part + size * std::sqrt(1.0 - correlation * correlation) * fresh;
  }
}

}  // namespace

FlownAircraft::FlownAircraft(const AircraftTruth& truth, const SimulationOptions& options,
                             const HiddenEffects& hidden)
    : truth_(truth),
      hidden_(hidden),
      excitation_(options.excitation == Excitation::rich ? 1.0 : 0.2) {
  static_assert(aero_regressors.size() == n_regressors);
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < n_regressors; ++k) {
      const std::string name = std::string(aero_names[i]) + "_" + aero_regressors[k];
      const auto found = truth.parameters.find(name);
      aero_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          found == truth.parameters.end() ? 0.0 : found->second;
    }
  }
  trim();
  fly(options.seed);
}

std::string_view FlownAircraft::label(double time) const {
  for (const ManeuverFlown& part : maneuvers_flown) {
    const bool elevator = part.label.starts_with("elevator");
    if (time >= part.begin && time < part.end && (excitation_ == 1.0 || elevator)) {
      return part.label;
    }
  }
  return "level";
}

std::vector<std::string> FlownAircraft::drivers() {
  return {"time",     "alpha",   "beta",   "p_hat",    "q_hat",        "r_hat",
          "elevator", "aileron", "rudder", "airspeed", "imu_temp_degc"};
}

double FlownAircraft::unit_temperature(double time) {
  return 28.0 + 9.0 * (1.0 - std::exp(-time / 12.0)) + 2.5 * std::sin(2.0 * pi * time / 17.0);
}

Moment FlownAircraft::moment(const AircraftTruth& truth, const Flown& at) {
  const double V = at.air.norm();
  const AircraftGeometry& g = truth.geometry;
  const bool twice = g.rate_reference == RateReference::chord_per_twice_speed;
  const Vector3d& w = at.state.rates;
  return {
      at.time,
      {at.time, std::atan2(at.air[2], at.air[0]), std::asin(at.air[1] / V),
       w[0] * g.span / (2.0 * V), w[1] * g.chord / (twice ? 2.0 * V : V), w[2] * g.span / (2.0 * V),
       at.controls[0], at.controls[1], at.controls[2], V, unit_temperature(at.time)}};
}

/// Forces by what the air does to it, motion by Newton and Euler in a frame that does not turn.
FlownAircraft::Rates FlownAircraft::rates_of(double time, const FlightState& state,
                                             const Vector3d& gust, const Vector3d& shock,
                                             const Vector3d& controls) const {
  const auto of = [&](const char* name) { return truth_.parameters.at(name); };
  const AircraftGeometry& g = truth_.geometry;
  const Matrix3d body_to_ned = turn_of(state).toRotationMatrix();
  const Vector3d wind(of("w_n"), of("w_e"), of("w_d"));
  Flown flown{time, state, {}, {}, {}, controls, standard_air(state.altitude).density};
  flown.air = body_to_ned.transpose() * (state.velocity - wind) - gust;
  const Vector3d change = hidden_.sum_vector("wind", moment(truth_, flown));
  flown.air -= body_to_ned.transpose() * change;
  const Moment now = moment(truth_, flown);
  const double alpha = now.values[1];
  Eigen::Vector<double, n_regressors> regressors;
  regressors << 1.0, alpha, alpha * alpha, now.values[2], now.values[3], now.values[4],
      now.values[5], controls;
  Eigen::Vector<double, 6> C = aero_ * regressors;
  for (std::size_t i = 0; i < 6; ++i) {
    C[static_cast<Eigen::Index>(i)] += hidden_.sum(aero_names[i], now);
  }
  const double force = 0.5 * flown.rho * flown.air.squaredNorm() * g.area;
  const Vector3d pull = force * C.head<3>() + Vector3d(thrust_, 0, 0);
  const Vector3d moment(force * g.span * C[3], force * g.chord * C[4], force * g.span * C[5]);
  Matrix3d inertia;
  inertia << g.inertia.Ix, 0, -g.inertia.Ixz, 0, g.inertia.Iy, 0, -g.inertia.Ixz, 0, g.inertia.Iz;
  flown.force = pull / g.mass;
  flown.rates_dot = inertia.inverse() * (moment - state.rates.cross(inertia * state.rates)) + shock;
  const Vector4d& e = state.quaternion;
  const Vector3d& w = state.rates;
  Rates rates{{}, flown};
  rates.change.velocity = body_to_ned * flown.force + Vector3d(0, 0, standard_gravity);
  rates.change.quaternion << -e[1] * w[0] - e[2] * w[1] - e[3] * w[2],
      e[0] * w[0] + e[2] * w[2] - e[3] * w[1], e[0] * w[1] - e[1] * w[2] + e[3] * w[0],
      e[0] * w[2] + e[1] * w[1] - e[2] * w[0];
  rates.change.quaternion *= 0.5;
  rates.change.rates = flown.rates_dot;
  rates.change.altitude = -state.velocity[2];
  return rates;
}

Vector3d FlownAircraft::controls_at(double time, const FlightState& state) const {
  Vector3d controls = excitation_ * surfaces_moved(time);
  if (excitation_ < 1.0) controls.tail<2>().setZero();
  controls[0] += elevator_;
  const Matrix3d R = turn_of(state).toRotationMatrix();
  const double bank = std::atan2(R(2, 1), R(2, 2));
  controls[1] += 0.1 * bank * (truth_.parameters.at("Cl_aileron") < 0.0 ? 1.0 : -1.0);
  return controls;
}

/// Level flight: alpha, elevator and thrust for which nothing accelerates, by Newton's method with
/// differences.
void FlownAircraft::trim() {
  const auto left_over = [&](const Vector3d& x) -> Vector3d {
    thrust_ = x[2];
    FlightState state{
        {}, {std::cos(0.5 * x[0]), 0, std::sin(0.5 * x[0]), 0}, Vector3d::Zero(), truth_.altitude};
    const Vector3d wind(truth_.parameters.at("w_n"), truth_.parameters.at("w_e"),
                        truth_.parameters.at("w_d"));
    state.velocity = Vector3d(truth_.airspeed, 0, 0) + wind;
    const Rates rates = rates_of(0.0, state, Vector3d::Zero(), Vector3d::Zero(), {x[1], 0, 0});
    return {rates.change.velocity[0], rates.change.velocity[2], rates.change.rates[1]};
  };
  const Vector3d steps(1e-5, 1e-5, 1.0);
  Vector3d x(0.03, 0.0, 0.1 * truth_.geometry.mass * standard_gravity);
  for (int round = 0; round < 30; ++round) {
    const Vector3d here = left_over(x);
    Matrix3d slopes;
    for (int i = 0; i < 3; ++i) {
      Vector3d there = x;
      there[i] += steps[i];
      slopes.col(i) = (left_over(there) - here) / steps[i];
    }
    x -= slopes.fullPivLu().solve(here);
  }
  if (!(left_over(x).norm() < 1e-6) || std::abs(x[0]) > 0.5) {
    throw Error(truth_.source + ": the aircraft finds no level flight at " +
                format_number(truth_.airspeed) +
                " m/s; choose another airspeed, or CZ_alpha and Cm_elevator below zero");
  }
  alpha_ = x[0];
  elevator_ = x[1];
  thrust_ = x[2];
}

void FlownAircraft::check_flies(const Flown& at) const {
  constexpr double largest_angle = 1.2;  // of the flow, rad
  constexpr double fastest_turn = 10.0;  // rad/s
  const bool ahead = at.air[0] > std::cos(largest_angle) * at.air.norm();
  if (ahead && at.state.rates.norm() < fastest_turn) return;
  throw Error(truth_.source + ": the aircraft tumbles at " + format_number(at.time) +
              " s; choose it stable (Cm_alpha and Cm_q below zero, Cn_beta above), or less "
              "turbulence");
}

void FlownAircraft::fly(std::uint64_t seed) {
  RandomNumbers random(seed * 2 + 1);
  const int steps = static_cast<int>(std::lround(duration / integration_step));
  const double h = integration_step;
  const double correlation = std::exp(-truth_.airspeed * h / truth_.gust_length);
  FlightState state{{truth_.airspeed + truth_.parameters.at("w_n"), truth_.parameters.at("w_e"),
                     truth_.parameters.at("w_d")},
                    {std::cos(0.5 * alpha_), 0, std::sin(0.5 * alpha_), 0},
                    Vector3d::Zero(),
                    truth_.altitude};
  Vector3d gust = Vector3d::Zero();
  stir(gust, truth_.turbulence, 0.0, random);
  for (int k = 0; k <= steps; ++k) {
    const double t = h * k;
    Vector3d shock;
    for (double& part : shock) part = truth_.process_noise / std::sqrt(h) * random.draw_normal();
    const auto rates = [&](const FlightState& at, double time) {
      return rates_of(time, at, gust, shock, controls_at(time, at));
    };
    const Rates one = rates(state, t);
    flown_.push_back(one.flown);
    check_flies(one.flown);
    const Rates two = rates(moved(state, one.change, 0.5 * h), t + 0.5 * h);
    const Rates three = rates(moved(state, two.change, 0.5 * h), t + 0.5 * h);
    const Rates four = rates(moved(state, three.change, h), t + h);
    state = moved(state, one.change, h / 6.0);
    state = moved(state, two.change, h / 3.0);
    state = moved(state, three.change, h / 3.0);
    state = moved(state, four.change, h / 6.0);
    state.quaternion.normalize();
    stir(gust, truth_.turbulence, correlation, random);
  }
}

Flown FlownAircraft::at(double time) const {
  const double place =
      std::clamp(time / integration_step, 0.0, static_cast<double>(flown_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(place), flown_.size() - 2);
  const double share = place - static_cast<double>(i);
  const Flown& a = flown_[i];
  const Flown& b = flown_[i + 1];
  const auto between = [share](const auto& from, const auto& to) {
    return (from + share * (to - from)).eval();
  };
  const auto number = [share](double from, double to) { return from + share * (to - from); };
  return {
      time,
      {between(a.state.velocity, b.state.velocity), between(a.state.quaternion, b.state.quaternion),
       between(a.state.rates, b.state.rates), number(a.state.altitude, b.state.altitude)},
      between(a.force, b.force),
      between(a.rates_dot, b.rates_dot),
      between(a.air, b.air),
      between(a.controls, b.controls),
      number(a.rho, b.rho)};
}

}  // namespace sepcal::simulation
