// SPDX-License-Identifier: BSD-3-Clause
// The columns of a boom with two vanes and a Pitot tube.
#pragma once

#include <span>

#include "flight/probes/quantities.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"

namespace sepcal::probes {

std::span<const ProbeQuantity> vane_boom_quantities();

/// time [s]; roll, pitch, yaw [rad]; p, q, r [rad/s]; vn, ve, vd [m/s]; airspeed [m/s] as read, of
/// dp and the density where both are there, else of airspeed_mps; alpha, beta [rad], the vanes as
/// read. The rates are zeros where they are not needed (`lever_arm`: whether they are) and not
/// logged. For effects also rho, ps and temperature [K], where they are logged or can be computed
/// in every row. Rows without airspeed and rows with a vane at 90 deg or beyond are dropped. Throws
/// Error as prepare_five_hole() does, where neither way to the airspeed is there, and where more
/// than a fifth of the rows are dropped for one of the two reasons.
ProbeRecord prepare_vane_boom(const Flight& flight, bool lever_arm, const LogChoice& log);

/// airspeed [m/s], alpha, beta [rad] and rho [kg/m^3] of every row, rho that of the sea level
/// (1.225) where it can't be had; a row that prepare_vane_boom() would drop is not valid. Throws
/// Error as it does for these columns.
ProbeReadings read_vane_boom(const Flight& flight, const LogChoice& log);

}  // namespace sepcal::probes
