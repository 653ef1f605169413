// SPDX-License-Identifier: BSD-3-Clause
// The bodies by probe.
#pragma once

#include <Eigen/Core>

#include "flight/export/probe_body.hpp"

namespace sepcal::exporting {

/// m = C h + n.
struct FieldMatrix {
  Eigen::Matrix3d C;
  Eigen::Vector3d n;  // uT
};

/// As a probe that corrects three readings has it at its own parameters. Throws Error where C is
/// singular.
FieldMatrix field_matrix(const Calibration& calibration);

ProbeBody magnetometer_body(const FieldMatrix& field, bool up_to_rotation,
                            const Correction& correction, const Dialect& dialect);
ProbeBody pitot_static_body(const Calibration& calibration, const Correction& correction,
                            const Dialect& dialect);
ProbeBody five_hole_body(const Calibration& calibration, const Correction& correction,
                         const Dialect& dialect);

}  // namespace sepcal::exporting
