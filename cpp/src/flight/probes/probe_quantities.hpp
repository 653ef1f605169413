// SPDX-License-Identifier: BSD-3-Clause
// What each probe that ships reads of a log, needed or not.
#pragma once

#include <span>

#include "flight/probes/quantities.hpp"

namespace sepcal::probes {

std::span<const ProbeQuantity> five_hole_quantities();
std::span<const ProbeQuantity> pitot_static_quantities();
std::span<const ProbeQuantity> magnetometer_quantities();

/// The same log, of which a fit against the field's strength alone takes the three readings.
std::span<const ProbeQuantity> attitude_independent_quantities();

}  // namespace sepcal::probes
