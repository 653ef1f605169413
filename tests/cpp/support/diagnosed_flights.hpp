// SPDX-License-Identifier: BSD-3-Clause
// Simulated flights, calibrated without the effects that are hidden in them, and diagnosed.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "flights_with_effects.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"

namespace sepcal::test {

/// For each probe an effect about ten standard errors large in 400 rows with this noise.
struct HiddenCase {
  std::string_view probe;
  SizedEffect effect;
  double noise;
};

inline const std::vector<HiddenCase> strong_effects{
    {"five-hole", {"wind[altitude_m]", {0.012, -0.018}}, 0.15},
    {"five-hole", {"airspeed_scale[alpha^2]", {-0.8}}, 0.15},
    {"pitot-static", {"wind[altitude_m]", {0.02, -0.03}}, 0.15},
    {"pitot-static", {"airspeed_bias[throttle]", {1.0}}, 0.15},
    {"magnetometer", {"bias[current_a]", {0.04, -0.04, 0.04}}, 0.3},
    {"magnetometer", {"axis_scale[temp_degc]", {0.001, -0.001, 0.001}}, 0.3},
    {"magnetometer-norm", {"bias[current_a]", {0.06, -0.08, 0.06}}, 0.3}};

/// Of flights whose noise is white, and known to be.
inline DiagnosisOptions quick_diagnosis(std::string_view probe) {
  DiagnosisOptions options;
  for (const ErrorBound& bound : effect_kit(probe).error_budget)
    options.error_budget[bound.name] = 0.0;
  options.simulations = 49;
  options.threads = 1;
  return options;
}

/// A flight, its calibration without what is hidden, and what diagnose() says.
struct DiagnosedFlight {
  SimulatedFlight simulated;
  Flight flight;
  Calibration base;
  FlightDiagnosis result;
};

inline DiagnosedFlight diagnose_flight(std::string_view probe,
                                       const std::vector<SizedEffect>& hidden,
                                       const Conditions& conditions) {
  SimulatedFlight simulated = fly(probe, hidden, conditions);
  Flight flight = make_flight(simulated);
  Calibration base = calibrate_with(probe, simulated, {});
  FlightDiagnosis result = diagnose(base, flight, {}, quick_diagnosis(probe));
  return {std::move(simulated), std::move(flight), std::move(base), std::move(result)};
}

/// Fails where there is none of that name.
inline const EffectFinding& find(const FlightDiagnosis& result, std::string_view name) {
  const auto& effects = result.diagnosis.effects;
  const auto found = std::ranges::find(effects, name, &EffectFinding::name);
  CAPTURE(name);
  REQUIRE(found != effects.end());
  return *found;
}

inline bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

}  // namespace sepcal::test
