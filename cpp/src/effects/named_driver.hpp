// SPDX-License-Identifier: BSD-3-Clause
// The driver of a name `port[driver]`: its channel looked for in a record, what it takes from there
// (centre, knots, labels, span), and the unit of its coefficients.
#pragma once

#include <string>
#include <vector>

#include "sepcal/detail/driver.hpp"
#include "sepcal/detail/named_effects.hpp"

namespace sepcal::effects {

/// The driver on a port, its gaps in `setting` filled in from `record`, which gets the column
/// `maneuver` for labels and one for a product. A power of a channel that keeps away from zero goes
/// about its mean where the port takes a constant. Throws Error for a channel that isn't there,
/// holds no finite number somewhere or, in the record that the effect is first made for, doesn't
/// vary.
DriverPointer make_named_driver(const EffectName& name, const Port& port, EffectSetting& setting,
                                Record& record);

/// "m/s per m", "uT per degC^2"; the port's own unit where the driver is a function without one.
std::string coefficient_unit(const std::string& port_unit, const EffectName& name);

}  // namespace sepcal::effects
