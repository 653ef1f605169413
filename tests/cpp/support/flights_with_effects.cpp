// SPDX-License-Identifier: BSD-3-Clause
#include "flights_with_effects.hpp"

#include "sepcal/detail/flight/probe_effects.hpp"

namespace sepcal::test {

double field_strength() {
  const auto field = MagnetometerTruth{}.field;
  return Vector3d(field[0], field[1], field[2]).norm();
}

std::shared_ptr<const Probe> make_probe_called(std::string_view name) {
  if (name == "five-hole") return make_five_hole();
  if (name == "pitot-static") return pitot_static_probe();
  if (name == "magnetometer") return magnetometer_probe(std::nullopt);
  return attitude_independent_probe(field_strength());
}

CalibrationOptions options_with(const std::vector<std::string>& effects) {
  CalibrationOptions options;
  options.fit.samples = 100;
  options.fit.threads = 1;
  for (const std::string& effect : effects) options.effects.push_back({.name = effect});
  return options;
}

Calibration calibrate_with(std::string_view probe, const SimulatedFlight& flight,
                           const std::vector<std::string>& effects) {
  CalibrationOptions options = options_with(effects);
  if (probe == "magnetometer-norm") options.fit.samples = FitOptions{}.samples;  // it samples none
  return calibrate(make_probe_called(probe), make_flight(flight), options);
}

DiagnosedFit diagnosed_fit(const Calibration& calibration, const Flight& flight) {
  const Probe& probe = *calibration.probe;
  const Record record = probe.prepare(flight, {}).record;
  std::vector<EffectSetting> settings = calibration.options.effects;
  const auto rows = with_effects(probe, record, settings, {}).prepared.record.segments();
  return {.model = model_of(probe),
          .kit = effect_kit(probe.name()),
          .effects = settings,
          .record = record,
          .rows = rows,
          .fit = calibration.fit};
}

bool is_of_the_world(const std::string& effect) {
  return effect.starts_with("wind") || effect == "lever_arm" || effect == "heading_bias" ||
         effect == "field_declination";
}

std::vector<Eigen::ArrayXd> true_readings(std::string_view probe,
                                          const std::vector<SizedEffect>& effects,
                                          Conditions conditions) {
  conditions.noise = 0.0;
  conditions.perfect_sensor = true;
  std::vector<SizedEffect> of_the_world;
  for (const SizedEffect& effect : effects) {
    if (is_of_the_world(effect.name)) of_the_world.push_back(effect);
  }
  const SimulatedFlight flight = fly(probe, of_the_world, conditions);
  if (probe == "five-hole") {
    const Eigen::ArrayXd pressure = values(flight, "pt_pa") - values(flight, "ps_pa");
    return {(2.0 * pressure / values(flight, "rho_kgpm3")).sqrt(),
            values(flight, "dpa_pa") / (4.5 * pressure),
            values(flight, "dpb_pa") / (4.5 * pressure)};
  }
  if (probe == "pitot-static") return {values(flight, "airspeed_mps")};
  return {values(flight, "mx_ut"), values(flight, "my_ut"), values(flight, "mz_ut")};
}

}  // namespace sepcal::test
