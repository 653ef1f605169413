// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/kept_field.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "flight/export/bodies.hpp"
#include "flight/export/polar.hpp"
#include "flight/export/symmetric_magnetometer.hpp"
#include "flight/probes/mounting.hpp"
#include "flight/verbs/prepared_flight.hpp"

namespace sepcal::exporting {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::array suffixes{"x", "y", "z"};

/// From the calibration's body axes into those of another mounting.
Matrix3d turn_between(const Calibration& calibration, const std::optional<Mounting>& mounting) {
  if (!mounting) return Matrix3d::Identity();
  return probes::turn_by(*mounting) * field_matrix(calibration).turn.transpose();
}

/// Of a turn whose parts are eta [deg]; 0 where the fit has none.
double turn_error(const Calibration& calibration) {
  double square = 0.0;
  for (const char* const axis : suffixes) {
    const double error = calibration.fit[std::string("eta_") + axis].standard_error;
    if (std::isfinite(error)) square = std::max(square, error * error);
  }
  return std::sqrt(square) * 180.0 / std::numbers::pi;
}

/// The probe that turns its readings so.
std::shared_ptr<const Probe> mounted(const std::shared_ptr<const Probe>& probe,
                                     const std::optional<Mounting>& mounting) {
  if (!mounting) return probe;
  std::optional<std::array<double, 3>> field;
  const auto settings = probe->settings();
  if (const auto found = settings.find("field"); found != settings.end()) {
    field.emplace();
    std::ranges::copy(found->second, field->begin());
  }
  return magnetometer_probe(field, mounting);
}

/// The parameters of C symmetric, n and the calibration's effects, these two turned.
std::vector<Parameter> kept_parameters(const Calibration& calibration, const Matrix3d& C,
                                       const Vector3d& n, const Matrix3d& turn) {
  const std::array values{C(0, 0), C(1, 1), C(2, 2), C(0, 1), C(0, 2), C(1, 2), n[0], n[1], n[2]};
  std::vector<Parameter> parameters;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Quantity& quantity = SymmetricMagnetometer::linear.at(i);
    parameters.push_back({.name = std::string(quantity.name),
                          .unit = std::string(quantity.unit),
                          .value = values.at(i),
                          .standard_error = not_a_number,
                          .standard_error_white = not_a_number});
  }
  const Tables& own = calibration.probe->model().tables();
  for (const Parameter& one : calibration.fit.parameters) {
    const auto is_own = [&](const Variable& variable) { return variable.name == one.name; };
    if (std::ranges::none_of(own.parameters(), is_own)) parameters.push_back(one);
  }
  const auto component_of = [&](const std::string& effect, Eigen::Index i) -> double& {
    const std::string name = effect + "." + suffixes.at(static_cast<std::size_t>(i));
    return std::ranges::find(parameters, name, &Parameter::name)->value;
  };
  for (const std::string& effect : motor_effects(calibration)) {
    Vector3d s;
    for (Eigen::Index i = 0; i < 3; ++i) s[i] = component_of(effect, i);
    s = turn * s;
    for (Eigen::Index i = 0; i < 3; ++i) component_of(effect, i) = s[i];
  }
  return parameters;
}

/// What the options say of the calibration's parameters, of what stands for them here.
void restate_options(const Calibration& calibration, bool is_turned, Calibration& kept) {
  constexpr std::array<std::pair<const char*, const char*>, 6> entries{{{"lambda_x", "c_xx"},
                                                                        {"lambda_y", "c_yy"},
                                                                        {"lambda_z", "c_zz"},
                                                                        {"alpha_xy", "c_xy"},
                                                                        {"alpha_xz", "c_xz"},
                                                                        {"alpha_yz", "c_yz"}}};
  CalibrationOptions& options = kept.options;
  auto& fixed = options.fit.fix;
  for (const auto& [of_full, of_symmetric] : entries) {
    if (fixed.contains(of_full)) fixed[of_symmetric] = 0.0;  // its value follows
  }
  options.free.clear();
  if (is_turned) {
    std::vector<std::string> turned{"n_"};
    for (const std::string& effect : motor_effects(calibration)) turned.push_back(effect + ".");
    for (const std::string& prefix : turned) forget_ranges(prefix, options.fit);
  }
  keep_known(kept.probe->model().tables(), options);
  for (auto& [name, value] : fixed) value = kept.fit[name].value;
}

}  // namespace

std::optional<VehicleMounting> vehicle_mounting(const Calibration& calibration,
                                                const ExportOptions& options) {
  constexpr double askew = 5.0;  // deg: a sensor that is mounted by eye is no further off
  if (options.mounting) return VehicleMounting{*options.mounting, number_of(*options.mounting)};
  const std::optional<Mounting> own = mounting_of(calibration);
  if (!own) return std::nullopt;
  if (const auto number = number_of(*own)) return VehicleMounting{*own, number};
  const FieldMatrix field = field_matrix(calibration);
  const Matrix3d R = polar(field.C.inverse()).rotation * field.turn;
  const NumberedRotation nearest = nearest_rotation(R);
  const double error = turn_error(calibration);
  VehicleMounting found{.angles = nearest.angles,
                        .number = nearest.number,
                        .apart = nearest.apart,
                        .standard_error = error,
                        .found = true};
  if (nearest.apart > std::max(askew, 2.0 * error)) {
    found.angles = probes::angles_of(R);
    found.number = std::nullopt;
  }
  return found;
}

Calibration keep_held(const Calibration& calibration,
                      const std::optional<VehicleMounting>& vehicle) {
  std::optional<Mounting> mounting;  // instead of the calibration's own, where it has one
  if (vehicle && mounting_of(calibration)) mounting = vehicle->angles;
  const Matrix3d turn = turn_between(calibration, mounting);
  const FieldMatrix field = field_matrix(calibration);
  const Matrix3d C = polar((turn * field.C).inverse()).symmetric.inverse();
  Calibration kept = calibration;
  kept.probe = symmetric_magnetometer(mounted(calibration.probe, mounting));
  kept.fit.parameters = kept_parameters(calibration, C, turn * field.n, turn);
  const auto own = static_cast<int>(SymmetricMagnetometer::linear.size());
  const int own_before = calibration.probe->model().tables().n_1();
  kept.fit.n_1 = calibration.fit.n_1 - own_before + own;
  restate_options(calibration, mounting && mounting != mounting_of(calibration), kept);
  return kept;
}

Calibration refit_kept(const Calibration& kept, const Flight& flight, const FitProgress& progress) {
  CalibrationOptions options = options_without(kept, {}, progress);
  keep_known(kept.probe->model().tables(), options);
  return verbs::calibrate(kept.probe, verbs::prepare(kept, flight), options);
}

double angle_of(const Matrix3d& rotation) {
  return Eigen::AngleAxisd(rotation).angle() * 180.0 / std::numbers::pi;
}

Matrix3d lost_rotation(const Calibration& calibration, const Calibration& held) {
  const Matrix3d turn = turn_between(calibration, mounting_of(held));
  return polar((turn * field_matrix(calibration).C).inverse()).rotation;
}

}  // namespace sepcal::exporting
