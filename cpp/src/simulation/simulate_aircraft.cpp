// SPDX-License-Identifier: BSD-3-Clause
// What the sensors of an aircraft in flight read.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "sepcal/error.hpp"
#include "sepcal/simulation/aircraft.hpp"
#include "simulation/first_order_lag.hpp"
#include "simulation/flown_aircraft.hpp"
#include "simulation/simulated_flight.hpp"
#include "simulation/simulated_noise.hpp"

namespace sepcal {
namespace {

using namespace simulation;
using Eigen::Vector3d;

constexpr KnownEffect aircraft_effects[] = {
    {"CX", "CX", "*", "s"},
    {"CY", "CY", "*", "s"},
    {"CZ", "CZ", "*", "s"},
    {"Cl", "Cl", "*", "s"},
    {"Cm", "Cm", "*", "s"},
    {"Cn", "Cn", "*", "s"},
    {"accel_bias", "accel_bias", "*", "x y z"},
    {"gyro_bias", "gyro_bias", "*", "x y z"},
    {"accel_scale", "accel_scale", "*", "x y z"},
    {"gyro_scale", "gyro_scale", "*", "x y z"},
    {"airspeed_scale", "airspeed_scale", "*", "s"},
    {"wind", "wind", "*", "n e d"},
    {"imu_late", "imu_late", "", "tau"},
    {"airdata_late", "airdata_late", "", "tau"},
    {"attitude_late", "attitude_late", "", "tau"},
    {"velocity_late", "velocity_late", "", "tau"},
    {"alpha_lag", "alpha_lag", "", "tau"},
};
constexpr Alias aliases[] = {{"wind_drift", "wind[time]"}};
constexpr HiddenCatalogue aircraft_catalogue{"aircraft", aircraft_effects, aliases};

constexpr std::array<const char*, 15> sensor_channels{"ax",    "ay",       "az",    "p",    "q",
                                                      "r",     "airspeed", "alpha", "beta", "roll",
                                                      "pitch", "yaw",      "vn",    "ve",   "vd"};

void check(const AircraftTruth& truth, const SimulationOptions& options) {
  check_parameters(truth.source, without_effects(truth.parameters), AircraftTruth{}.parameters);
  for (const char* channel : sensor_channels) {
    if (!truth.noise.contains(channel)) {
      throw Error(truth.source + ": noise of '" + channel + "' is missing; give 0 for none");
    }
  }
  if (truth.noise.size() != sensor_channels.size()) {
    throw Error(fmt::format("{}: noise is of {}", truth.source, fmt::join(sensor_channels, ", ")));
  }
  for (const auto& [name, value] : truth.noise) {
    check_values(truth.source, "noise of " + name, std::array{value}, 0.0);
  }
  check_values(truth.source, "turbulence, process_noise",
               std::array{truth.turbulence, truth.process_noise}, 0.0);
  check_values(truth.source, "airspeed, gust_length", std::array{truth.airspeed, truth.gust_length},
               1.0);
  check_geometry(truth.geometry);
  if (!truth.geometry.has_inertia()) {
    throw Error(truth.source + ": the aircraft has no inertia; give Ix, Iy, Iz, Ixz");
  }
  if (options.excitation == Excitation::third) {
    throw Error("an aircraft can't fly the excitation third; choose rich or poor");
  }
}

/// Of the effects' drivers the ranges are those of a flight without them.
HiddenEffects hide(const AircraftTruth& truth, const SimulationOptions& options,
                   const std::vector<double>& times) {
  if (truth.effects.empty() && without_effects(truth.parameters) == truth.parameters) return {};
  static const HiddenEffects nothing;
  const FlownAircraft clean(truth, options, nothing);
  const Sources sources = list_sources(
      FlownAircraft::drivers(),
      [&](double time) { return FlownAircraft::moment(truth, clean.at(time)); },
      [&](double time) { return clean.label(time); }, times);
  return {aircraft_catalogue, truth.effects, truth.parameters, sources, truth.source};
}

/// The flight at the times that its sensors read.
struct Read {
  Flown inertial;
  Flown air;
  Flown attitude;
  Flown velocity;
};

/// Free of noise, in the order of `sensor_channels`.
Eigen::VectorXd read_sensors(const AircraftTruth& truth, const HiddenEffects& hidden,
                             const Flown& now, const Read& at) {
  const Flown& inertial = at.inertial;
  const auto of = [&](const char* name) { return truth.parameters.at(name); };
  const AircraftGeometry& g = truth.geometry;
  const Moment moment = FlownAircraft::moment(truth, now);
  const Vector3d imu = g.imu - g.cg;
  const Vector3d w = inertial.state.rates;
  const Vector3d acceleration = inertial.force + inertial.rates_dot.cross(imu) +
                                w.cross(w.cross(imu)) -
                                Vector3d(of("b_ax"), of("b_ay"), of("b_az"));
  const Vector3d gyro = w - Vector3d(of("b_p"), of("b_q"), of("b_r"));
  const Vector3d air = at.air.air + at.air.state.rates.cross(g.vane - g.cg);
  const auto rotation = [](const Flown& flown) {
    const Eigen::Vector4d e = flown.state.quaternion.normalized();
    return Eigen::Quaterniond(e[0], e[1], e[2], e[3]).toRotationMatrix();
  };
  const Eigen::Matrix3d R = rotation(at.attitude);
  Eigen::VectorXd read(15);
  const auto scaled = [&](const char* effect, const Vector3d& reading) {
    return Vector3d(reading + hidden.sum_vector(effect, moment).cwiseProduct(reading));
  };
  read.head<3>() = scaled("accel_scale", acceleration) + hidden.sum_vector("accel_bias", moment);
  read.segment<3>(3) = scaled("gyro_scale", gyro) + hidden.sum_vector("gyro_bias", moment);
  read[6] = (1.0 + of("lambda_v") + hidden.sum("airspeed_scale", moment)) * air.norm() + of("b_v");
  read[7] = (1.0 + of("lambda_alpha")) * std::atan2(air[2], air[0]) + of("b_alpha");
  read[8] = (1.0 + of("lambda_beta")) * std::asin(air[1] / air.norm()) + of("b_beta");
  read[9] = std::atan2(R(2, 1), R(2, 2));
  read[10] = -std::asin(R(2, 0));
  read[11] = std::atan2(R(1, 0), R(0, 0));
  const Vector3d swing = at.velocity.state.rates.cross(imu);
  read.tail<3>() = at.velocity.state.velocity + rotation(at.velocity) * swing;
  return read;
}

SimulatedFlight open_aircraft(std::size_t rows) {
  return open_flight(
      {"time_s",     "ax_mps2",      "ay_mps2",   "az_mps2",    "p_radps",      "q_radps",
       "r_radps",    "airspeed_mps", "alpha_rad", "beta_rad",   "roll_rad",     "pitch_rad",
       "yaw_rad",    "vn_mps",       "ve_mps",    "vd_mps",     "elevator_rad", "aileron_rad",
       "rudder_rad", "thrust_n",     "rho_kgpm3", "altitude_m", "imu_temp_degc"},
      rows);
}

void append(SimulatedFlight& flight, const FlownAircraft& aircraft, const Flown& now,
            const Eigen::VectorXd& r) {
  append_row(flight, aircraft.label(now.time),
             {now.time,
              r[0],
              r[1],
              r[2],
              r[3],
              r[4],
              r[5],
              r[6],
              r[7],
              r[8],
              r[9],
              r[10],
              wrap(r[11]),
              r[12],
              r[13],
              r[14],
              now.controls[0],
              now.controls[1],
              now.controls[2],
              aircraft.thrust(),
              now.rho,
              now.state.altitude,
              FlownAircraft::unit_temperature(now.time)});
}

}  // namespace

SimulatedFlight simulate_aircraft(const AircraftTruth& truth, const SimulationOptions& options) {
  check(truth, options);
  const std::vector<double> times = sample_times(0.0, FlownAircraft::duration, options);
  const HiddenEffects hidden = hide(truth, options, times);
  const FlownAircraft aircraft(truth, options, hidden);
  const auto constant = [&](const char* effect) {
    return hidden.has(effect) ? hidden.constant(effect) : 0.0;
  };
  const auto late = [&](const char* sensor) {
    return check_shift(truth.source + ": " + sensor, constant(sensor));
  };
  const double inertial = late("imu_late");
  const double air = late("airdata_late");
  const double attitude = late("attitude_late");
  const double velocity = late("velocity_late");
  const auto readings = [&](double time) {
    return read_sensors(truth, hidden, aircraft.at(time),
                        {aircraft.at(time - inertial), aircraft.at(time - air),
                         aircraft.at(time - attitude), aircraft.at(time - velocity)});
  };
  FirstOrderLag alpha(truth.source + ": alpha_lag", constant("alpha_lag"), times.front(),
                      [&](double time) -> Eigen::VectorXd { return readings(time).segment<1>(7); });
  SimulatedFlight flight = open_aircraft(times.size());
  Eigen::MatrixXd noise = make_noise(options.noise, times.size(), 15, options.seed);
  for (Eigen::Index j = 0; j < 15; ++j) {
    noise.col(j) *= truth.noise.at(sensor_channels[static_cast<std::size_t>(j)]);
  }
  for (const double time : times) {
    Eigen::VectorXd read = readings(time);
    read[7] = alpha.advance_to(time)[0];
    read += noise.row(static_cast<Eigen::Index>(flight.rows())).transpose();
    append(flight, aircraft, aircraft.at(time), read);
  }
  record_truth(flight, truth.parameters, hidden);
  add_decoys(flight, options);
  return flight;
}

}  // namespace sepcal
