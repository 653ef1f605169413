// SPDX-License-Identifier: BSD-3-Clause
// A diagnosis as text for people.
#pragma once

#include <string>

#include "sepcal/flight/flight_diagnosis.hpp"

namespace sepcal::app {

/// The verdict in a sentence, the ranked effects, and what to do next.
std::string diagnosis_table(const FlightDiagnosis& diagnosis, const std::string& app,
                            const std::string& calibration);

}  // namespace sepcal::app
