// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/five_hole_reading.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "sepcal/error.hpp"

namespace sepcal::simulation {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr KnownEffect effects[] = {
    {"wind", "wind", "*", "n e"},
    {"airspeed_scale", "airspeed_scale", "*", "s"},
    {"airspeed_bias", "airspeed_bias", "*", "s"},
    {"pressure_offset", "pressure_offset", "*", "s"},
    {"pressure_offset", "pressure_offset", "", "s"},
    {"alpha_offset", "alpha_offset", "*", "s"},
    {"beta_offset", "beta_offset", "*", "s"},
    {"heading_bias", "heading_bias", "", "delta"},
    {"time_offset", "time_offset", "", "tau"},
    {"clock_drift", "clock_drift", "", "tau"},
    {"pneumatic_lag", "pneumatic_lag", "", "tau"},
    {"lever_arm", "lever_arm", "", "x y z"},
    {"density_error", "density_error", "", "s"},
    {"compressibility", "compressibility", "", "s"},
    {"angle_loss", "angle_loss", "", "s"},
    {"upwash", "upwash", "", "k"},
    {"sidewash", "sidewash", "", "k"},
    {"mounting_error", "mounting_error", "", "pitch yaw"},
    {"icing_ramp", "airspeed_scale", "ramp(time)", "s"},
    {"water_blockage", "airspeed_scale", "step(time)", "s"},
};

}  // namespace

const HiddenCatalogue& five_hole_effects() {
  static constexpr HiddenCatalogue catalogue{"five-hole probe", effects, air_data_aliases};
  return catalogue;
}

double compressible_excess(double speed, const Air& air) {
  const double impact = 0.5 * air.density * speed * speed;
  const double mach_squared = 5.0 * std::expm1(std::log1p(impact / air.pressure) * 2.0 / 7.0);
  return std::sqrt(1.4 * air.pressure / air.density * mach_squared) / speed - 1.0;
}

Vector3d FiveHoleReader::meet_air(const AircraftState& state) const {
  const Vector3d lever_arm =
      Vector3d(truth_.lever_arm.data()) + Vector3d(hidden_.constant("lever_arm", 0),
                                                   hidden_.constant("lever_arm", 1),
                                                   hidden_.constant("lever_arm", 2));
  Vector3d velocity = state.velocity + state.rates.cross(lever_arm);
  if (hidden_.has("mounting_error")) {
    const Matrix3d turn =
        AngleAxisd(hidden_.constant("mounting_error", 1), Vector3d::UnitZ()).toRotationMatrix() *
        AngleAxisd(hidden_.constant("mounting_error", 0), Vector3d::UnitY()).toRotationMatrix();
    velocity = turn.transpose() * velocity;
  }
  // The probe's axes: C(eps)' of Eq. 38 is a positive turn about forward.
  const Vector3d met =
      AngleAxisd(parameter("eps_phi"), Vector3d::UnitX()).toRotationMatrix() * velocity;
  const double airspeed = met.norm();
  return {airspeed, std::atan2(met.z(), met.x()), std::asin(met.y() / airspeed)};
}

Vector3d FiveHoleReader::correct(const Vector3d& read, const AircraftState& state,
                                 Moment& now) const {
  now.values[now.values.size() - 2] = read[1];
  now.values[now.values.size() - 1] = read[2];
  const double density = state.air.density;
  double speed = std::sqrt(read[0] * read[0] + 2.0 * hidden_.sum("pressure_offset", now) / density);
  speed *= 1.0 + hidden_.constant("density_error") / (2.0 * state.air.temperature);
  double scale = 1.0 + parameter("lambda_va") + hidden_.sum("airspeed_scale", now);
  if (hidden_.has("compressibility")) {
    scale += hidden_.constant("compressibility") * compressible_excess(read[0], state.air);
  }
  const double along = std::cos(read[1]) * std::cos(read[2]);
  scale += hidden_.constant("angle_loss") * (1.0 - along * along);
  const double alpha = read[1] + hidden_.sum("alpha_offset", now) +
                       hidden_.constant("upwash") * state.rates.y() / speed;
  const double beta = read[2] + hidden_.sum("beta_offset", now) +
                      hidden_.constant("sidewash") * state.rates.x() / speed;
  return {scale * speed + parameter("b_va") + hidden_.sum("airspeed_bias", now),
          (1.0 + parameter("lambda_alpha")) * alpha + parameter("b_alpha"),
          (1.0 + parameter("lambda_beta")) * beta + parameter("b_beta")};
}

Vector3d FiveHoleReader::solve(const Vector3d& near, const Vector3d& met,
                               const AircraftState& state, Moment now) const {
  constexpr int most_steps = 50;
  constexpr double increment = 1e-5;  // of the numeric derivative [m/s, rad]
  const Vector3d weight(1.0 / met[0], 1.0, 1.0);
  Vector3d read = near;
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < most_steps; ++k) {
    const Vector3d residual = correct(read, state, now) - met;
    const double error = residual.cwiseProduct(weight).norm();
    // Newton with a numeric derivative gains eight digits a step: it ends at the rounding.
    if (error == 0.0 || (error < 1e-12 && error >= last)) return read;
    last = error;
    Matrix3d slope;
    for (int j = 0; j < 3; ++j) {
      const Vector3d aside = increment * Vector3d::Unit(j);
      slope.col(j) = (correct(read + aside, state, now) - correct(read - aside, state, now)) /
                     (2.0 * increment);
    }
    read -= slope.partialPivLu().solve(residual);
    if (!(read[0] > 0.0)) break;
  }
  throw Error(truth_.source + ": at " + format_number(now.time) +
              " s no reading makes the hidden effects right; choose smaller sizes");
}

FiveHoleReading FiveHoleReader::read(const AircraftState& state, const Moment& now) const {
  const Vector3d met = meet_air(state);
  const double indicated = (met[0] - parameter("b_va")) / (1.0 + parameter("lambda_va"));
  if (!(indicated > 0.0)) {
    throw Error(truth_.source + ": b_va = " + format_number(parameter("b_va")) +
                " m/s leaves the probe nothing to read at " + format_number(met[0]) +
                " m/s of airspeed; choose it smaller");
  }
  const Vector3d free{indicated,
                      (met[1] - parameter("b_alpha")) / (1.0 + parameter("lambda_alpha")),
                      (met[2] - parameter("b_beta")) / (1.0 + parameter("lambda_beta"))};
  const Vector3d read = hidden_.names().empty() ? free : solve(free, met, state, now);
  const double impact = 0.5 * state.air.density * read[0] * read[0];
  return {state.air.pressure + impact,
          state.air.pressure,
          truth_.k_alpha * impact * read[1],
          truth_.k_beta * impact * read[2],
          read[1],
          read[2]};
}

}  // namespace sepcal::simulation
