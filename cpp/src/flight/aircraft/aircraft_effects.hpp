// SPDX-License-Identifier: BSD-3-Clause
// Effects of an aircraft, COEFFICIENT[REGRESSOR]: what its coefficients may lack. A product of
// powers joins the coefficient's equation; a spline, whose knots come from the flight that it is
// first fitted to, stands beside the equations of `aero`.
#pragma once

#include <string>
#include <vector>

#include "sepcal/detail/named_effects.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal::aircraft_log {

/// The place of the effect's coefficient. Throws Error, which says how an effect is written and
/// what coefficients there are, for anything else.
std::size_t find_equation(const std::string& effect, const std::vector<AeroEquation>& equations,
                          AircraftModel model);

/// The equations with those of the effects that are products. Throws Error for an effect that is no
/// regressor of one of these coefficients, or that stands there already.
std::vector<AeroEquation> with_regressors(std::vector<AeroEquation> equations,
                                          const AircraftOptions& options);

/// Whether it is a coefficient's spline, "Cm[spline(alpha,5)]".
bool is_spline(const std::string& effect);

/// Those of the effects that are no products.
std::vector<EffectSetting> splines_of(const std::vector<EffectSetting>& effects);

/// Throws Error, which says what takes them, where there are any.
void refuse_splines(const AircraftOptions& options, const std::string& why);

/// The same effects with what the splines among them took from their flight.
std::vector<EffectSetting> with_knots(std::vector<EffectSetting> effects,
                                      const std::vector<EffectSetting>& splines);

/// A port for every coefficient, which its equation need not have a constant for.
EffectKit coefficient_kit(const std::vector<AeroEquation>& equations);

bool has_regressor(const AeroEquation& equation, const std::string& effect);

/// What these equations may lack, by name: of each coefficient the regressors that
/// usual_regressors() has and every other numeric channel of the log.
std::vector<std::string> list_regressors(const std::vector<AeroEquation>& equations,
                                         const Record& record, const Flight& flight);

/// Those that are no splines: of regressors that do the same they are what people know.
std::vector<std::string> products_among(std::vector<std::string> names);

/// That diagnose() tries for a coefficient, beside channels of the log.
std::vector<std::string> usual_regressors(const std::string& coefficient);

/// "the pitching moment changes with alpha^2"
std::string describe_regressor(const std::string& effect);

}  // namespace sepcal::aircraft_log
