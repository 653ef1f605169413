// SPDX-License-Identifier: BSD-3-Clause
// What both autopilots can hold of a probe, and the calibration that is the best of that kind:
// fitted, not cut out of a richer one.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/export.hpp"

namespace sepcal::exporting {

enum class Motor { none, throttle, current };

/// h = W (m - n - kappa x), W symmetric; x the motors' current [A] or the throttle [0 to 1].
struct HeldField {
  Eigen::Matrix3d W = Eigen::Matrix3d::Identity();
  Eigen::Vector3d n = Eigen::Vector3d::Zero();      // uT
  Eigen::Vector3d kappa = Eigen::Vector3d::Zero();  // uT per A, or at full throttle
  Motor motor = Motor::none;
  std::string column = {};  // of x
  double unit = 1.0;        // of the column, in A or of full throttle
};

/// Throws Error that names the first effect which `target` (with words) can't follow.
void check_held(const Calibration& calibration, ExportTarget target);

/// Effects that act on the reference or the wind, not on the reading.
std::vector<std::string> effects_on_the_world(const Calibration& calibration);

/// Whether it is of a magnetometer against a known field, which shows how the sensor is turned.
bool is_of_known_field(const Calibration& calibration);

/// Effects that the motors' columns drive.
std::vector<std::string> motor_effects(const Calibration& calibration);

/// Of what keep_held() or refit_kept() gave, or of a magnetometer against the field's strength.
HeldField held_field(const Calibration& calibration);

/// Options for a fit without some of the base's effects, from where it ended.
CalibrationOptions options_without(const Calibration& base, const std::vector<std::string>& effects,
                                   const FitProgress& progress);

/// Forgets what the options say of parameters that begin so; of ranges all but fixed values.
void forget_ranges(std::string_view prefix, FitOptions& fit);
void forget(std::string_view prefix, FitOptions& fit);

/// Keeps of the options what is said of the parameters of another model and of the effects.
void keep_known(const Tables& model, CalibrationOptions& options);

}  // namespace sepcal::exporting
