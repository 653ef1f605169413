// SPDX-License-Identifier: BSD-3-Clause
// Flights of every probe with effects hidden in them by the simulator, the probes that calibrate
// them, and what a perfect sensor would have read.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "calibrated_flights.hpp"
#include "sepcal/diagnosis.hpp"
#include "sepcal/effect_name.hpp"

namespace sepcal::test {

inline constexpr std::array all_probes{"five-hole", "pitot-static", "magnetometer",
                                       "magnetometer-norm"};

/// The strength of MagnetometerTruth's field [uT].
double field_strength();

/// The probe of the simulator's default truth.
std::shared_ptr<const Probe> make_probe_called(std::string_view name);

/// How a flight is simulated: the standard deviation of all noise, in the outputs' unit.
struct Conditions {
  std::size_t rows = 400;
  double noise = 0.0;
  std::uint64_t seed = 0;
  bool perfect_sensor = false;  // no errors but those of the effects
  bool misaligned = true;       // of a magnetometer
  double altitude = 300.0;      // of an aircraft, at the first row [m]
};

template <class Truth>
Truth truth_of(const std::vector<SizedEffect>& effects, const Conditions& conditions) {
  Truth truth;
  truth.effects = effects;
  truth.noise.fill(conditions.noise);
  if constexpr (requires { truth.altitude; }) truth.altitude = conditions.altitude;
  for (const char* rotation : {"eta_x", "eta_y", "eta_z"}) {
    if (!conditions.misaligned && truth.parameters.contains(rotation)) {
      truth.parameters[rotation] = 0.0;
    }
  }
  if (!conditions.perfect_sensor) return truth;
  for (auto& [name, value] : truth.parameters) {
    if (!name.starts_with("w_")) value = name == "s_va" ? 1.0 : 0.0;
  }
  return truth;
}

inline SimulatedFlight fly(std::string_view probe, const std::vector<SizedEffect>& effects,
                           const Conditions& conditions = {}) {
  const SimulationOptions options = condensed(conditions.rows, conditions.seed);
  if (probe == "five-hole") {
    return simulate_five_hole(truth_of<FiveHoleTruth>(effects, conditions), options);
  }
  if (probe == "pitot-static") {
    return simulate_pitot_static(truth_of<PitotStaticTruth>(effects, conditions), options);
  }
  // A rotation is not seen in the field's strength, so that it would stay in the corrected field.
  Conditions of_magnetometer = conditions;
  if (probe == "magnetometer-norm") of_magnetometer.misaligned = false;
  return simulate_magnetometer(truth_of<MagnetometerTruth>(effects, of_magnetometer), options);
}

CalibrationOptions options_with(const std::vector<std::string>& effects);

Calibration calibrate_with(std::string_view probe, const SimulatedFlight& flight,
                           const std::vector<std::string>& effects);

/// What diagnose() makes of a calibration and a flight. The calibration must outlive it.
DiagnosedFit diagnosed_fit(const Calibration& calibration, const Flight& flight);

/// Effects on the world or on the navigation, which a perfect sensor has as well.
bool is_of_the_world(const std::string& effect);

/// What apply() should give (a column each): the readings of a perfect sensor on the same flight.
std::vector<Eigen::ArrayXd> true_readings(std::string_view probe,
                                          const std::vector<SizedEffect>& effects,
                                          Conditions conditions);

}  // namespace sepcal::test
