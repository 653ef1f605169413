// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/flight/flight_factor.hpp"

#include <algorithm>

#include "flight/catalogue/effect_candidates.hpp"
#include "flight/verbs/prepared_flight.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"

namespace sepcal {

using namespace verbs;  // this room's own

namespace {

/// Whether its coefficients alone are to be found, and its driver is no function of any form: a
/// flight knots a spline where it flew, and labels its maneuvers as it likes.
bool is_of_fleets(const std::string& text) {
  if (split_effects(text).size() > 1) return false;
  const EffectName name = parse_effect_name(text);
  return name.shape != EffectName::Shape::spline && name.shape != EffectName::Shape::levels &&
         name.base != "maneuver";
}

}  // namespace

std::vector<std::string> list_fleet_candidates(const Calibration& calibration,
                                               const Flight& flight) {
  const PreparedFlight prepared = prepare(calibration, flight);
  const OwnEffects& own = calibration.options.own_effects;
  const DiagnosedFit fitted = diagnosed_fit(calibration, prepared.readings.record, own);
  std::vector<std::string> names = catalogue::list_candidates(
      calibration.probe->effects(), fitted.kit, fitted.record, prepared.flight);
  for (const auto& [name, maker] : own) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  std::erase_if(names, [&](const std::string& name) {
    return !is_of_fleets(name) ||
           std::ranges::find(fitted.effects, name, &EffectSetting::name) != fitted.effects.end();
  });
  return names;
}

FlightFactor reduce(const Calibration& calibration, const Flight& flight,
                    const ReduceOptions& options) {
  const PreparedFlight prepared = prepare(calibration, flight);
  try {
    return reduce(
        diagnosed_fit(calibration, prepared.readings.record, calibration.options.own_effects),
        options);
  } catch (const Error& error) {
    throw Error(flight.name() + ": " + error.what());
  }
}

}  // namespace sepcal
