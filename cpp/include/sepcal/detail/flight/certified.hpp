// SPDX-License-Identifier: BSD-3-Clause
// Whether a calibration is the least cost within its bounds, on the flight that was fitted.
#pragma once

#include "sepcal/certificate.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal {

/// As certify() of its fit. Throws Error as that does, for bad input, as calibrate() does, for
/// another file than the one that was fitted, and for a calibration with effects.
Certificate certify(const Calibration& calibration, const Flight& flight,
                    const CertificateOptions& options = {});

}  // namespace sepcal
