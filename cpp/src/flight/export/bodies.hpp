// SPDX-License-Identifier: BSD-3-Clause
// The bodies by probe.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "flight/export/probe_body.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"

namespace sepcal::exporting {

/// turn m = C h + n.
struct FieldMatrix {
  Eigen::Matrix3d C;
  Eigen::Vector3d n;                                   // uT
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // from the sensor's axes into the body's
};

/// How the calibration's sensor is turned; nothing where it is not.
std::optional<Mounting> mounting_of(const Calibration& calibration);

/// As a probe that corrects three readings has it at its own parameters. Throws Error where C is
/// singular.
FieldMatrix field_matrix(const Calibration& calibration);

ProbeBody magnetometer_body(const FieldMatrix& field, bool up_to_rotation,
                            const Correction& correction, const Dialect& dialect);

}  // namespace sepcal::exporting
