// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/exporter.hpp"

namespace sepcal::exporting {

const Exporter& exporter_of(const Calibration& calibration) {
  return *find_exporter(calibration.probe->name());
}

bool is_magnetometer(const Calibration& calibration) {
  return exporter_of(calibration).held == HeldAs::field;
}

}  // namespace sepcal::exporting
