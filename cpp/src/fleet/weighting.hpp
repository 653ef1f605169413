// SPDX-License-Identifier: BSD-3-Clause
// Whether parameters depend on how rows are weighed. Where the model is right they do not: weights
// against the noise's memory make them surer alone. Noise in an input pulls them, and the more the
// more the fast part of a flight weighs (Hausman 1978, Econometrica 46, pp. 1251-1271).
#pragma once

#include <string>
#include <vector>

#include "sepcal/fleet.hpp"

namespace sepcal::fleet {

/// What to say of the parameter that moves most, by the scatter of the difference between vehicles;
/// empty where none does, or for fewer than three vehicles.
std::string note_weighting(const std::vector<FleetFlight>& flights, double significance);

}  // namespace sepcal::fleet
