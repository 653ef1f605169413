// SPDX-License-Identifier: BSD-3-Clause
// A vehicle turns a magnetometer through the whole sphere in a uniform Earth field. The sensor has
// scale errors, misaligned axes, soft iron and hard iron (Sun & Gebre-Egziabher, Eq. B1).
#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "simulated_flight.hpp"

namespace sepcal {
namespace {

using namespace simulation;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double full_duration = 320.0;      // [s]
constexpr double condensed_duration = 80.0;  // [s]

constexpr std::array<std::string_view, 4> maneuvers{"figure_eight", "bank", "pitch", "tumble"};

/// The four maneuvers one after the other, each a quarter of the flight; x runs from 0 to 1 over
/// the whole. Six slow circles below them turn the heading all the way round.
Attitude turn_vehicle(Moving x) {
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

/// Turns the true field in body axes [uT] into the sensor's axes and scales, without the bias.
Matrix3d distortion(const std::map<std::string, double>& truth) {
  const auto parameter = [&](const char* name) { return truth.at(name); };
  const Vector3d eta(parameter("eta_x"), parameter("eta_y"), parameter("eta_z"));
  const Vector3d lambda(parameter("lambda_x"), parameter("lambda_y"), parameter("lambda_z"));
  Matrix3d misalignment = Matrix3d::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    misalignment.col(axis) += eta.cross(Vector3d::Unit(axis));  // I + [eta x]
  }
  Matrix3d soft_iron = Matrix3d::Identity();
  soft_iron(0, 1) = soft_iron(1, 0) = parameter("alpha_xy");
  soft_iron(0, 2) = soft_iron(2, 0) = parameter("alpha_xz");
  soft_iron(1, 2) = soft_iron(2, 1) = parameter("alpha_yz");
  const Vector3d scale = Vector3d::Ones() + lambda;
  return soft_iron * misalignment * scale.asDiagonal();
}

void check(const MagnetometerTruth& truth) {
  check_parameters(truth.source, truth.parameters, MagnetometerTruth{}.parameters);
  check_values(truth.source, "field", truth.field);
  check_values(truth.source, "magnetometer noise", truth.noise, 0.0);
}

}  // namespace

SimulatedFlight simulate_magnetometer(const MagnetometerTruth& truth,
                                      const SimulationOptions& options) {
  check(truth);
  const double duration = options.rows == 0 ? full_duration : condensed_duration;
  const std::vector<double> times = sample_times(0.0, duration, options);
  const Vector3d field(truth.field.data());
  const Matrix3d distorted = distortion(truth.parameters);
  const Vector3d bias(truth.parameters.at("n_x"), truth.parameters.at("n_y"),
                      truth.parameters.at("n_z"));
  Noise noise(options.seed);

  SimulatedFlight flight = open_flight(
      {"time_s", "mx_ut", "my_ut", "mz_ut", "roll_rad", "pitch_rad", "yaw_rad", "p_radps",
       "q_radps", "r_radps", "bn_ut", "be_ut", "bd_ut", "temp_degc", "current_a"},
      times.size());
  flight.truth = truth.parameters;

  for (const double time : times) {
    const double x = time / duration;
    const Attitude attitude = turn_vehicle({x, 1.0 / duration});
    const Vector3d rates = attitude.body_rates();
    const Vector3d true_field = attitude.body_to_ned().transpose() * field;
    const Vector3d read = distorted * true_field + bias + noise.draw(truth.noise);
    const std::size_t quarter = std::min<std::size_t>(static_cast<std::size_t>(4.0 * x), 3);
    append_row(flight, maneuvers[quarter],
               {time, read.x(), read.y(), read.z(), wrap(attitude.roll.value), attitude.pitch.value,
                wrap(attitude.yaw.value), rates.x(), rates.y(), rates.z(), field.x(), field.y(),
                field.z(), 35.0 - 15.0 * std::exp(-3.0 * x),
                12.0 + 4.0 * std::sin(0.37 * time) + 6.0 * rates.squaredNorm()});
  }
  return flight;
}

}  // namespace sepcal
