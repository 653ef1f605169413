// SPDX-License-Identifier: BSD-3-Clause
// Equation error asked coefficient by coefficient: they share no parameter, so that what one lacks
// is no rival of what another lacks. Probabilities are corrected for the candidates of all.
#pragma once

#include "flight/aircraft/laid_aircraft.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::aircraft_log {

/// What each of the coefficients lacks, the surest first. Where rates were differentiated, moments
/// are asked in rows that share no reading: neighbours' noise is nearly singular there, and
/// regressors with noise of their own would be weighed by where that alone is left. A note says so.
Diagnosis diagnose_coefficients(const AircraftFit& fitted, const Flight& flight, LaidAircraft& laid,
                                const DiagnosisOptions& options);

/// All coefficients at once, as the engine's diagnosis takes a fit.
DiagnosedFit diagnosed_coefficients(const AircraftFit& fitted, const LaidAircraft& laid);

}  // namespace sepcal::aircraft_log
