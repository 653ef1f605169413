// SPDX-License-Identifier: BSD-3-Clause
// Which sensor a tube has, and how an autopilot reads it: by the options, else by what the flight's
// log said of the vehicle's parameters.
#pragma once

#include <string>
#include <vector>

#include "flight/export/held_airspeed.hpp"

namespace sepcal::exporting {

struct ChosenTubeReader {
  TubeReader reader;
  std::vector<std::string> notes;  // how the sensor is known, or that it is not
};

/// `flight`: as the calibration reads it (read_as.hpp). Throws OptionError for options that
/// contradict one another, or of a sensor that is not there.
ChosenTubeReader choose_tube_reader(const Flight& flight, const ExportOptions& options);

}  // namespace sepcal::exporting
