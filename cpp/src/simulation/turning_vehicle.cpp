// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/turning_vehicle.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "sepcal/error.hpp"

namespace sepcal::simulation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double full_duration = 320.0;      // [s]
constexpr double condensed_duration = 80.0;  // [s]

constexpr std::array<std::string_view, 4> maneuvers{"figure_eight", "bank", "pitch", "tumble"};

/// The four maneuvers one after the other, each a quarter of the flight; x runs from 0 to 1 over
/// the whole. Six slow circles below them turn the heading all the way round.
Attitude turn_all_round(Moving x) {
  const auto quarter = [&](int k) { return 4.0 * x - static_cast<double>(k); };
  const auto swing = [](Moving part, double cycles) {
    return window(part) * sin(2.0 * pi * cycles * part);
  };
  Attitude attitude;
  attitude.yaw = 12.0 * pi * x + 1.5 * swing(quarter(0), 2.0);
  attitude.roll =
      0.9 * swing(quarter(0), 4.0) + 1.4 * swing(quarter(1), 3.0) + 8.0 * pi * step(quarter(3));
  attitude.pitch = 1.4 * swing(quarter(2), 3.0) + 1.3 * swing(quarter(3), 1.0);
  return attitude;
}

/// Within 16 deg of level and 45 deg of one heading.
Attitude turn_a_little(Moving x) {
  constexpr double tilt = 16.0 * pi / 180.0;
  Attitude attitude;
  attitude.roll = tilt * sin(22.0 * pi * x);
  attitude.pitch = tilt * sin(34.0 * pi * x + 1.0);
  attitude.yaw = 0.6 + 0.25 * pi * sin(6.0 * pi * x);
  return attitude;
}

/// Attitude against axes of which the third is the field's direction. Pitch within 60 deg and roll
/// within 180/pi (pi/3)/sin 60 = 69.3 deg: the field's directions in body axes are those of a patch
/// of 2 roll 2 sin(pitch) = 4 pi/3 steradians.
Attitude turn_through_third(Moving x) {
  const double pitch = pi / 3.0;
  const double roll = pi / 3.0 / std::sin(pitch);
  Attitude attitude;
  attitude.roll = roll * sin(22.0 * pi * x);
  attitude.pitch = pitch * sin(34.0 * pi * x + 1.0);
  attitude.yaw = 2.0 * sin(6.0 * pi * x);
  return attitude;
}

/// Roll, pitch and yaw of a rotation from body axes to NED, (3) [rad].
Vector3d find_angles(const Matrix3d& turn) {
  return {std::atan2(turn(2, 1), turn(2, 2)), -std::asin(std::clamp(turn(2, 0), -1.0, 1.0)),
          std::atan2(turn(1, 0), turn(0, 0))};
}

}  // namespace

TurningVehicle::TurningVehicle(const SimulationOptions& options, const Vector3d& field)
    : excitation_(options.excitation),
      duration_(options.rows == 0 ? full_duration : condensed_duration),
      field_to_ned_(Matrix3d::Identity()),
      times_(sample_times(0.0, duration_, options)) {
  if (excitation_ != Excitation::third) return;
  if (field.isZero(0.0)) {
    throw Error("excitation 'third' turns about the Earth's field, and the field is zero");
  }
  field_to_ned_ = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), field).toRotationMatrix();
}

VehicleState TurningVehicle::at(double time) const {
  const Moving x{time / duration_, 1.0 / duration_};
  VehicleState state;
  if (excitation_ == Excitation::third) {
    const Attitude attitude = turn_through_third(x);
    state.body_to_ned = field_to_ned_ * attitude.body_to_ned();
    state.angles = find_angles(state.body_to_ned);
    state.rates = attitude.body_rates();
  } else {
    const Attitude attitude =
        excitation_ == Excitation::poor ? turn_a_little(x) : turn_all_round(x);
    state.body_to_ned = attitude.body_to_ned();
    state.angles = {wrap(attitude.roll.value), attitude.pitch.value, wrap(attitude.yaw.value)};
    state.rates = attitude.body_rates();
  }
  state.temperature = 35.0 - 15.0 * std::exp(-3.0 * x.value) + 5.0 * wander(0.4 * time, 1);
  state.throttle = 0.5 + 0.5 * std::tanh(1.2 * wander(time, 2));
  state.current =
      3.0 + 16.0 * state.throttle * std::sqrt(state.throttle) + 4.0 * (1.0 + wander(time, 3));
  state.voltage = 25.0 - 1.5 * x.value - 0.08 * state.current;
  state.panel_current = 1.5 * (1.0 + wander(time, 4));
  return state;
}

std::string_view TurningVehicle::label(double time) const {
  if (excitation_ == Excitation::poor) return "level";
  if (excitation_ == Excitation::third) return "tilt";
  return maneuvers[static_cast<std::size_t>(std::clamp(4.0 * time / duration_, 0.0, 3.0))];
}

Moment TurningVehicle::moment(double time, const VehicleState& state) {
  return {time,
          {time, state.rates.x(), state.rates.y(), state.rates.z(), state.temperature,
           state.current, state.throttle, state.voltage, state.panel_current}};
}

Sources TurningVehicle::sources() const {
  return list_sources(
      {"time", "p", "q", "r", "temp_degc", "current_a", "throttle", "voltage_v", "panel_current_a"},
      [this](double time) { return moment(time, at(time)); },
      [this](double time) { return label(time); }, times_);
}

}  // namespace sepcal::simulation
