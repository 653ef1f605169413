// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/parameters.hpp"

#include <fmt/format.h>

#include "sepcal/error.hpp"

namespace sepcal::exporting {

void check_range(const VehicleParameter& parameter, double lowest, double highest) {
  if (parameter.value >= lowest && parameter.value <= highest) return;
  throw OptionError(
      {fmt::format("{} would be {:.6g}, and the autopilot takes {:.4g} to {:.4g}: the "
                   "readings are in another unit, or the fit is wrong; ",
                   parameter.name, parameter.value, lowest, highest),
       Option{"to"}, " c holds it all the same"});
}

int sensor_of(const ExportOptions& options, int first, int last, std::string_view what) {
  const int sensor = options.sensor.value_or(first);
  if (sensor >= first && sensor <= last) return sensor;
  throw OptionError({Option{"sensor"},
                     fmt::format(" {}: {} are counted from {} to {}", sensor, what, first, last)});
}

std::string float_text(double value) { return fmt::format("{}", static_cast<float>(value) + 0.0F); }

}  // namespace sepcal::exporting
