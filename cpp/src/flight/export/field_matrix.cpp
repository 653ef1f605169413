// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/bodies.hpp"
#include "flight/export/symmetric_magnetometer.hpp"
#include "flight/probes/mounting.hpp"
#include "sepcal/models/attitude_independent_magnetometer.hpp"
#include "sepcal/models/magnetometer.hpp"

namespace sepcal::exporting {

std::optional<Mounting> mounting_of(const Calibration& calibration) {
  const auto settings = calibration.probe->settings();
  const auto mounting = settings.find("mounting");
  if (mounting == settings.end() || mounting->second.size() != 3) return std::nullopt;
  return Mounting{mounting->second[0], mounting->second[1], mounting->second[2]};
}

FieldMatrix field_matrix(const Calibration& calibration) {
  const Eigen::VectorXd values = own_values(calibration);
  if (calibration.probe->name() == "magnetometer-norm") {
    const Vec<double, 9> xi2 = values.head<9>();
    return {AttitudeIndependentMagnetometer::soft_iron_and_scale<double>(xi2), xi2.tail<3>()};
  }
  const Eigen::Matrix3d turn = probes::turn_by(mounting_of(calibration).value_or(Mounting{}));
  if (calibration.probe->model().tables().nonlinear.empty()) {
    return {SymmetricMagnetometer::matrix(values), values.segment<3>(6), turn};
  }
  const Eigen::Vector3d scale = values.head<3>().array() + 1.0;
  const Vec<double, 6> xi2 = values.tail<6>();
  return {Magnetometer::soft_iron_and_misalignment<double>(xi2) * scale.asDiagonal(),
          values.segment<3>(3), turn};
}

ProbeBody body_of(const Calibration& calibration, const Correction& correction,
                  const Dialect& dialect) {
  const std::string_view probe = calibration.probe->name();
  if (probe == "five-hole") return five_hole_body(calibration, correction, dialect);
  if (probe == "pitot-static") return pitot_static_body(calibration, correction, dialect);
  return magnetometer_body(field_matrix(calibration), probe == "magnetometer-norm", correction,
                           dialect);
}

}  // namespace sepcal::exporting
