// SPDX-License-Identifier: BSD-3-Clause
// What exporting asks of a probe. Each stands beside the probe's body.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "flight/export/bodies.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal::exporting {

/// What an autopilot holds of the correction.
enum class HeldAs { nothing, airspeed, field };

struct Exporter {
  std::string_view instrument;   // "a five-hole probe"
  std::string_view header_name;  // "five_hole"
  /// Expressions of a correction by channel.
  std::map<std::string, std::string, std::less<>> readings;
  /// A header in float takes total less static pressure, and these by themselves as drivers.
  bool by_difference = false;
  std::string_view density_scales = {};  // the port that an error of the density scales
  HeldAs held = HeldAs::nothing;
  bool of_known_field = false;
  ProbeBody (*body)(const Calibration& calibration, const Correction& correction,
                    const Dialect& dialect) = nullptr;
  /// Statements before the effects, which may follow what they define.
  std::string (*before_effects)(const Dialect& dialect) = nullptr;
  FieldMatrix (*field)(const Calibration& calibration) = nullptr;  // of a magnetometer
};

const Exporter& five_hole_exporter();
const Exporter& pitot_static_exporter();
const Exporter& known_field_exporter();
const Exporter& field_strength_exporter();

/// Of a probe by its name; nullptr: it has no correction to export. Defined in registry/, which
/// knows all that ship.
const Exporter* find_exporter(std::string_view probe);

/// The probes that have one, by their names. Defined there too.
std::vector<std::string_view> exported_probes();

/// Of its probe, which has one: export_calibration() refuses any other.
const Exporter& exporter_of(const Calibration& calibration);

bool is_magnetometer(const Calibration& calibration);

}  // namespace sepcal::exporting
