// SPDX-License-Identifier: BSD-3-Clause
// Effects along the trajectory of a fit: the catalogue's, of its own sensors and the wind, and of
// an aircraft the regressors, with which it is built anew.
#pragma once

#include <string>
#include <vector>

#include "flight/aircraft/laid_aircraft.hpp"
#include "sepcal/detail/named_effects.hpp"
#include "sepcal/diagnosis.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal::aircraft_log {

/// Whether a name is of an effect along the model's trajectory, not of a regressor.
bool acts_along(AircraftModel model, const std::string& effect);

/// "the gyros' bias changes with imu_temp_degc", "the pitching moment changes with alpha^2"
std::string describe_along(AircraftModel model, const std::string& effect);

/// What a trajectory may lack, by name: of a path its effects, of an aircraft regressors too.
std::vector<std::string> list_along(const AircraftFit& fitted, const LaidAircraft& laid,
                                    const Flight& flight);

/// As the engine's diagnosis takes it, at a fit of what is laid. `asked`: effects that it must
/// know, whether list_along() has them or not.
DiagnosedFit diagnosed_trajectory(const AircraftFit& fitted, const Fit& fit,
                                  const LaidAircraft& laid, const Flight& flight,
                                  const std::vector<std::string>& asked = {});

/// What an effect promised at a fit before it was added, by one step: `next` tells the times of its
/// steps. Nothing of equation error, and where it can't be tried.
Promise promise_along(const AircraftFit& fitted, const Flight& flight, const AircraftFit& next,
                      const std::string& effect);

/// The kit of these for a model without effects: of its inputs and linear parameters.
EffectKit trajectory_kit(AircraftModel model, const Tables& tables);

/// Regressors that an aircraft is built anew with, "Cm[alpha^2]", "Cm[spline(alpha,5)]".
void add_regressors(const std::vector<std::string>& names, EffectKit& kit);

}  // namespace sepcal::aircraft_log
