// SPDX-License-Identifier: BSD-3-Clause
// Where a fit to the field's strength alone begins, within which bounds, and what its end is worth:
// readings that cover little of the sphere fit a huge ellipsoid far away nearly as well as the
// true one.
#pragma once

#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal::probes {

/// The options with bounds of n, two field strengths either side of the middle of the readings, and
/// with a start: the readings' ellipsoid where it is within all bounds, else a sphere. `record` has
/// mx, my, mz [uT]; the start is from stage one's segments. Throws Error for bounds that are open,
/// and where readings all round an ellipsoid have another size than the bounds of lambda and the
/// field's strength [uT] allow.
FitOptions start_attitude_independent(const FitOptions& options, const Record& record,
                                      double field_strength);

/// Lists eta_x, eta_y, eta_z as unobservable. A parameter at its bound makes the fit not
/// identifiable: with readings that leave the ellipsoid's size or place open, that is where the fit
/// ends, and the standard errors of the others, as if the bound were the truth, would hide it. So
/// do standard errors past 0.08 (n: of `field_strength` [uT]), where intervals no longer cover.
void judge_attitude_independent(Fit& fit, double field_strength);

}  // namespace sepcal::probes
