// SPDX-License-Identifier: BSD-3-Clause
// What a diagnosis promises of an effect, held against a full fit with it.
#include <cmath>

#include "diagnosed_flights.hpp"

namespace diagnosis_numbers_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;

namespace {

struct Added {
  HiddenCase hidden;
  DiagnosedFlight flight;
  Calibration next;

  const EffectFinding& finding() const { return find(flight.result, hidden.effect.name); }
};

/// Effects that join the model linearly or nearly so, too small to bend it; diagnosed and added.
const std::vector<Added>& added_effects() {
  static const std::vector<Added> all = [] {
    std::vector<Added> made;
    for (const HiddenCase& hidden :
         {HiddenCase{"five-hole", {"wind[altitude_m]", {0.012, -0.018}}, 0.15},
          HiddenCase{"five-hole", {"airspeed_scale[alpha^2]", {-0.8}}, 0.15},
          HiddenCase{"pitot-static", {"airspeed_bias[throttle]", {0.6}}, 0.15},
          HiddenCase{"magnetometer", {"bias[current_a]", {0.04, -0.04, 0.04}}, 0.3},
          HiddenCase{"magnetometer-norm", {"bias[current_a]", {0.06, -0.08, 0.06}}, 0.3}}) {
      DiagnosedFlight flight =
          diagnose_flight(hidden.probe, {hidden.effect}, {.noise = hidden.noise, .seed = 11});
      Calibration next = add(flight.base, flight.flight, hidden.effect.name);
      made.push_back({hidden, std::move(flight), std::move(next)});
    }
    return made;
  }();
  return all;
}

}  // namespace

TEST_CASE("the drop that is promised is the drop that adding the effect achieves") {
  for (const Added& added : added_effects()) {
    CAPTURE(added.hidden.probe);
    CAPTURE(added.hidden.effect.name);
    const HistoryEntry& entry = added.next.history.back();
    const double achieved = 1.0 - entry.rmse_after / entry.rmse_before;
    CHECK(achieved > 0.02);
    CHECK(std::abs(added.finding().predicted_drop / achieved - 1.0) < 0.05);
    CHECK(added.flight.result.diagnosis.rmse == Approx(entry.rmse_before).epsilon(1e-6));
  }
}

TEST_CASE("what the parameters absorb of an effect is how far they move when it joins") {
  for (const Added& added : added_effects()) {
    CAPTURE(added.hidden.probe);
    CAPTURE(added.hidden.effect.name);
    REQUIRE(!added.finding().absorbed_by.empty());
    double largest = 0.0;
    for (const auto& [name, shift] : added.finding().absorbed_by) {
      CAPTURE(name);
      const Parameter& before = added.flight.base.fit[name];
      const double moved = before.value - added.next.fit[name].value;
      CHECK(std::abs(shift - moved) < 0.2 * before.standard_error + 0.1 * std::abs(moved));
      largest = std::max(largest, std::abs(moved) / before.standard_error);
    }
    CHECK(largest > 0.6);  // else there was nothing to compare
  }
}

TEST_CASE("one step estimates what the full fit does, with its standard error") {
  for (const Added& added : added_effects()) {
    CAPTURE(added.hidden.probe);
    CAPTURE(added.hidden.effect.name);
    for (const Coefficient& coefficient : added.finding().coefficients) {
      CAPTURE(coefficient.name);
      const Parameter& fitted = added.next.fit[coefficient.name];
      CHECK(coefficient.unit == fitted.unit);
      CHECK(std::abs(coefficient.estimate - fitted.value) < 0.5 * fitted.standard_error);
      CHECK(std::abs(coefficient.standard_error / fitted.standard_error - 1.0) < 0.15);
    }
  }
}

TEST_CASE("the error on rows held out falls by about as much, to the noise at best") {
  for (const Added& added : added_effects()) {
    CAPTURE(added.hidden.probe);
    CAPTURE(added.hidden.effect.name);
    const EffectFinding& effect = added.finding();
    CHECK(effect.held_out_passed);
    CHECK(effect.held_out_gain == Approx(1.0 - effect.held_out_after / effect.held_out_before));
    CHECK(effect.held_out_after > added.hidden.noise * 0.9);
    CHECK(effect.held_out_gain > 0.3 * effect.predicted_drop);
    CHECK(effect.held_out_gain < 2.0 * effect.predicted_drop);
  }
}

}  // namespace diagnosis_numbers_test
