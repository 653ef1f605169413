// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/bodies.hpp"
#include "flight/export/exporter.hpp"
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

namespace {

FieldMatrix known_field_matrix(const Calibration& calibration) {
  const Eigen::VectorXd values = own_values(calibration);
  const Eigen::Matrix3d turn = probes::turn_by(mounting_of(calibration).value_or(Mounting{}));
  if (calibration.probe->model().tables().nonlinear.empty()) {
    return {SymmetricMagnetometer::matrix(values), values.segment<3>(6), turn};
  }
  const Eigen::Vector3d scale = values.head<3>().array() + 1.0;
  const Vec<double, 6> xi2 = values.tail<6>();
  return {Magnetometer::soft_iron_and_misalignment<double>(xi2) * scale.asDiagonal(),
          values.segment<3>(3), turn};
}

FieldMatrix field_strength_matrix(const Calibration& calibration) {
  const Eigen::VectorXd values = own_values(calibration);
  const Vec<double, 9> xi2 = values.head<9>();
  return {AttitudeIndependentMagnetometer::soft_iron_and_scale<double>(xi2), xi2.tail<3>()};
}

ProbeBody known_field_body(const Calibration& calibration, const Correction& correction,
                           const Dialect& dialect) {
  return magnetometer_body(field_matrix(calibration), false, correction, dialect);
}

ProbeBody field_strength_body(const Calibration& calibration, const Correction& correction,
                              const Dialect& dialect) {
  return magnetometer_body(field_matrix(calibration), true, correction, dialect);
}

const std::map<std::string, std::string, std::less<>> field_readings{
    {"mx", "m_ut[0]"},    {"my", "m_ut[1]"},    {"mz", "m_ut[2]"},
    {"mx_ut", "m_ut[0]"}, {"my_ut", "m_ut[1]"}, {"mz_ut", "m_ut[2]"}};

}  // namespace

const Exporter& known_field_exporter() {
  static const Exporter exporter{.instrument = "a magnetometer",
                                 .header_name = "magnetometer",
                                 .readings = field_readings,
                                 .held = HeldAs::field,
                                 .of_known_field = true,
                                 .body = known_field_body,
                                 .field = known_field_matrix};
  return exporter;
}

const Exporter& field_strength_exporter() {
  static const Exporter exporter{.instrument = "a magnetometer",
                                 .header_name = "magnetometer",
                                 .readings = field_readings,
                                 .held = HeldAs::field,
                                 .body = field_strength_body,
                                 .field = field_strength_matrix};
  return exporter;
}

FieldMatrix field_matrix(const Calibration& calibration) {
  return exporter_of(calibration).field(calibration);
}

}  // namespace sepcal::exporting
