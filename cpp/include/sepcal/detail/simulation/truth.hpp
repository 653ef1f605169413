// SPDX-License-Identifier: BSD-3-Clause
// The truth behind a simulated flight, as JSON: {"model", "parameters" {name: value}, "options"
// {k_alpha, k_beta, lever_arm | field}, "noise" {output: standard deviation}, "effects" [names of
// the hidden effects, where there are any; their values stand in "parameters"]}. What a file leaves
// out keeps its default, so that a file may name just what it changes.
#pragma once

#include <string>
#include <string_view>

#include "sepcal/simulation/aircraft.hpp"
#include "sepcal/simulation/simulate.hpp"

namespace sepcal {

std::string to_json(const FiveHoleTruth& truth);
std::string to_json(const PitotStaticTruth& truth);
std::string to_json(const MagnetometerTruth& truth);
std::string to_json(const AircraftTruth& truth);  // and "aircraft", see flight/aircraft_file.hpp

/// The truth as it was flown: every parameter of the hidden effects has its value, by name.
template <class Truth>
Truth as_flown(Truth truth, const SimulatedFlight& flight) {
  truth.parameters = flight.truth;
  truth.effects.clear();
  for (const std::string& effect : flight.effects) truth.effects.push_back({.name = effect});
  return truth;
}

/// Throws Error, opened by `source`, for text that is no JSON object of this kind, a name that the
/// model doesn't have, or a value that is no number. A name with a dot is taken for a hidden
/// effect's parameter; whether there is such an effect is seen when the truth is flown. For a
/// magnetometer the option field_strength [uT] stretches the field to that length.
FiveHoleTruth parse_five_hole_truth(std::string_view json, const std::string& source);
PitotStaticTruth parse_pitot_static_truth(std::string_view json, const std::string& source);
MagnetometerTruth parse_magnetometer_truth(std::string_view json, const std::string& source);
AircraftTruth parse_aircraft_truth(std::string_view json, const std::string& source);

}  // namespace sepcal
