// SPDX-License-Identifier: BSD-3-Clause
// The motion of an aircraft under its own forces, integrated in small steps and kept: known at any
// time of the flight.
#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "sepcal/simulation/aircraft.hpp"
#include "simulation/hidden_effects.hpp"

namespace sepcal::simulation {

/// Over the ground, NED; the attitude as a quaternion w x y z from body to NED.
struct FlightState {
  Eigen::Vector3d velocity;    // m/s
  Eigen::Vector4d quaternion;  // unit
  Eigen::Vector3d rates;       // body axes, rad/s
  double altitude;             // m
};

/// What sensors could know at a time.
struct Flown {
  double time;
  FlightState state;
  Eigen::Vector3d force;      // specific, body axes, at the centre of gravity, m/s^2
  Eigen::Vector3d rates_dot;  // rad/s^2
  Eigen::Vector3d air;        // velocity through the air, body axes, m/s
  Eigen::Vector3d controls;   // elevator, aileron, rudder, rad
  double rho;                 // kg/m^3
};

class FlownAircraft {
 public:
  static constexpr double duration = 40.0;  // s

  /// Trims and flies. Throws Error as simulate_aircraft() does.
  FlownAircraft(const AircraftTruth& truth, const SimulationOptions& options,
                const HiddenEffects& hidden);

  double thrust() const { return thrust_; }  // N
  std::string_view label(double time) const;

  /// Between two steps a straight line; before the first and after the last, these.
  Flown at(double time) const;

  static Moment moment(const AircraftTruth& truth, const Flown& at);
  static std::vector<std::string> drivers();

  /// Of the inertial unit, which warms up under a heater that goes on and off [degC].
  static double unit_temperature(double time);

 private:
  struct Rates {
    FlightState change;
    Flown flown;
  };

  Rates rates_of(double time, const FlightState& state, const Eigen::Vector3d& gust,
                 const Eigen::Vector3d& shock, const Eigen::Vector3d& controls) const;
  Eigen::Vector3d controls_at(double time, const FlightState& state) const;
  void trim();
  void check_flies(const Flown& at) const;
  void fly(std::uint64_t seed);

  const AircraftTruth& truth_;
  const HiddenEffects& hidden_;
  static constexpr int n_regressors = 10;
  Eigen::Matrix<double, 6, n_regressors> aero_;  // CX ... Cn, by what they are sums of
  double excitation_;                            // 1, or less
  double thrust_ = 0.0;
  double elevator_ = 0.0;  // trimmed
  double alpha_ = 0.0;     // the same
  std::vector<Flown> flown_;
};

}  // namespace sepcal::simulation
