// SPDX-License-Identifier: BSD-3-Clause
// A magnetometer on a vehicle in a uniform Earth field. The sensor has scale errors, misaligned
// axes, soft iron and hard iron (Sun & Gebre-Egziabher, Eq. B1).
#include <Eigen/Geometry>

#include "simulation/first_order_lag.hpp"
#include "simulation/hidden_effects.hpp"
#include "simulation/lateness.hpp"
#include "simulation/simulated_noise.hpp"
#include "simulation/turning_vehicle.hpp"

namespace sepcal {
namespace {

using namespace simulation;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr KnownEffect magnetometer_effects[] = {
    {"bias", "bias", "*", "x y z"},
    {"scale", "scale", "*", "s"},
    {"axis_scale", "axis_scale", "*", "x y z"},
    {"bias_step", "bias", "step(time)", "x y z"},
    {"warm_up", "bias", "decay(time)", "x y z"},
    {"cubic_nonlinearity", "cubic_nonlinearity", "", "d_x d_y d_z c_x c_y c_z"},
    {"eddy_currents", "eddy_currents", "", "xx xy xz yx yy yz zx zy zz"},
    {"time_offset", "time_offset", "", "tau"},
    {"clock_drift", "clock_drift", "", "tau"},
    {"sensor_lag", "sensor_lag", "", "tau"},
    {"field_declination", "field_declination", "", "delta"},
    {"attitude_bias", "attitude_bias", "", "x y"},
};
constexpr Alias aliases[] = {{"bias_drift", "bias[time]"}};
constexpr HiddenCatalogue magnetometer_catalogue{"magnetometer", magnetometer_effects, aliases};

void check(const MagnetometerTruth& truth) {
  check_parameters(truth.source, without_effects(truth.parameters), MagnetometerTruth{}.parameters);
  check_values(truth.source, "field", truth.field);
  check_values(truth.source, "magnetometer noise", truth.noise, 0.0);
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

/// What the sensor reads [uT], free of noise and lag.
class Sensor {
 public:
  /// Both must outlive the sensor.
  Sensor(const MagnetometerTruth& truth, const HiddenEffects& hidden)
      : hidden_(hidden),
        distorted_(distortion(truth.parameters)),
        bias_(truth.parameters.at("n_x"), truth.parameters.at("n_y"), truth.parameters.at("n_z")),
        field_(Eigen::AngleAxisd(hidden.constant("field_declination"), Vector3d::UnitZ()) *
               Vector3d(truth.field.data())) {}

  Vector3d read(const VehicleState& state, const Moment& now) const {
    Vector3d h = state.body_to_ned.transpose() * field_;
    h += h.cross(Vector3d(constant("attitude_bias", 0), constant("attitude_bias", 1), 0.0));
    Vector3d read = distorted_ * h + bias_ + hidden_.sum_vector("bias", now);
    read += hidden_.sum("scale", now) * h;
    read += hidden_.sum_vector("axis_scale", now).cwiseProduct(h);
    const Vector3d field_rate = h.cross(state.rates);  // a fixed field, seen from the body
    for (int i = 0; i < 3; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      read[i] += constant("cubic_nonlinearity", axis) * h[i] * h[i] * h[i] +
                 constant("cubic_nonlinearity", 3 + axis) * h[i] * h[i];
      for (int j = 0; j < 3; ++j) {
        read[i] +=
            constant("eddy_currents", 3 * axis + static_cast<std::size_t>(j)) * field_rate[j];
      }
    }
    return read;
  }

 private:
  double constant(const char* port, std::size_t component) const {
    return hidden_.constant(port, component);
  }

  const HiddenEffects& hidden_;
  Matrix3d distorted_;
  Vector3d bias_;
  Vector3d field_;  // the true one, north, east, down [uT]
};

HiddenEffects hide(const MagnetometerTruth& truth, const TurningVehicle& vehicle) {
  if (truth.effects.empty() && without_effects(truth.parameters) == truth.parameters) return {};
  return {magnetometer_catalogue, truth.effects, truth.parameters, vehicle.sources(), truth.source};
}

}  // namespace

SimulatedFlight simulate_magnetometer(const MagnetometerTruth& truth,
                                      const SimulationOptions& options) {
  check(truth);
  const Vector3d field(truth.field.data());
  const TurningVehicle vehicle(options, field);
  const HiddenEffects hidden = hide(truth, vehicle);
  const Sensor sensor(truth, hidden);
  const Lateness late(hidden, vehicle.times(), truth.source);
  FirstOrderLag reading(truth.source + ": sensor_lag", hidden.constant("sensor_lag"),
                        vehicle.times().front() - late.at(vehicle.times().front()),
                        [&](double time) -> Eigen::VectorXd {
                          const VehicleState state = vehicle.at(time);
                          return sensor.read(state, TurningVehicle::moment(time, state));
                        });

  SimulatedFlight flight =
      open_flight({"time_s", "mx_ut", "my_ut", "mz_ut", "roll_rad", "pitch_rad", "yaw_rad",
                   "p_radps", "q_radps", "r_radps", "bn_ut", "be_ut", "bd_ut", "temp_degc",
                   "current_a", "throttle", "voltage_v", "panel_current_a"},
                  vehicle.times().size());
  const Eigen::MatrixXd noise = make_noise(options.noise, vehicle.times().size(), 3, options.seed);
  const Vector3d sigma(truth.noise.data());
  for (const double time : vehicle.times()) {
    const VehicleState state = vehicle.at(time);
    const auto row = static_cast<Eigen::Index>(flight.rows());
    const Vector3d read =
        reading.advance_to(time - late.at(time)) + noise.row(row).transpose().cwiseProduct(sigma);
    append_row(
        flight, vehicle.label(time),
        {time, read.x(), read.y(), read.z(), state.angles[0], state.angles[1], state.angles[2],
         state.rates.x(), state.rates.y(), state.rates.z(), field.x(), field.y(), field.z(),
         state.temperature, state.current, state.throttle, state.voltage, state.panel_current});
  }
  record_truth(flight, truth.parameters, hidden);
  add_decoys(flight, options);
  return flight;
}

}  // namespace sepcal
