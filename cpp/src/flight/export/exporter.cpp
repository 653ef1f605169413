// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/exporter.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace sepcal::exporting {

const Exporter* find_exporter(std::string_view probe) {
  using Named = std::pair<std::string_view, const Exporter& (*)()>;
  constexpr std::array exporters{Named{"five-hole", five_hole_exporter},
                                 Named{"pitot-static", pitot_static_exporter},
                                 Named{"magnetometer", known_field_exporter},
                                 Named{"magnetometer-norm", field_strength_exporter}};
  const auto* const found = std::ranges::find(exporters, probe, &Named::first);
  return found == exporters.end() ? nullptr : &found->second();
}

const Exporter& exporter_of(const Calibration& calibration) {
  return *find_exporter(calibration.probe->name());
}

bool is_magnetometer(const Calibration& calibration) {
  return exporter_of(calibration).held == HeldAs::field;
}

}  // namespace sepcal::exporting
