// SPDX-License-Identifier: BSD-3-Clause
// Steps in a fit: their times held where the caller holds them, and two at once.
#include "estimation/step_times.hpp"

#include "flights_with_steps.hpp"
#include "sepcal/detail/flight/probe_effects.hpp"

namespace step_times_test {

using namespace sepcal;
using namespace sepcal::test;

TEST_CASE("a time that the caller holds stays, and one outside the bounds is not found") {
  const SimulatedFlight flight =
      fly("magnetometer", {bias_step}, {.rows = 300, .noise = 0.3, .seed = 1});
  CalibrationOptions options = options_with({"bias_step"});
  options.fit.fix["bias_step.t0"] = 40.0;
  const auto probe = make_probe_called("magnetometer");
  const Calibration held = calibrate(probe, make_flight(flight), options);
  CHECK(held.fit["bias_step.t0"].value == 40.0);
  CHECK(held.options.effects[0].t0 == 40.0);
  options.fit.fix.clear();
  options.fit.bounds["bias_step.t0"] = {50.0, 70.0};
  options.fit.bounds["bias_step.x"] = {-10.0, 10.0};
  const Calibration bounded = calibrate(probe, make_flight(flight), options);
  CHECK(bounded.fit["bias_step.t0"].value >= 50.0);
  CHECK(bounded.fit["bias_step.t0"].value <= 70.0);
}

TEST_CASE("coefficients that the caller holds or bounds are no hindrance") {
  const SimulatedFlight flight =
      fly("magnetometer", {bias_step}, {.rows = 300, .noise = 0.3, .seed = 2});
  CalibrationOptions options = options_with({"bias_step"});
  options.fit.fix["bias_step.x"] = 2.0;
  options.fit.bounds["bias_step.z"] = {0.0, 2.5};
  const Calibration calibration =
      calibrate(make_probe_called("magnetometer"), make_flight(flight), options);
  CHECK(error_of(calibration, flight, "bias_step.t0") < row_interval(flight));
  CHECK(calibration.fit["bias_step.x"].value == 2.0);
  CHECK(calibration.fit["bias_step.z"].at_bound);
}

TEST_CASE("two steps are found at once, in either order") {
  const std::vector<SizedEffect> hidden{{"bias_step", {2.0, -1.0, 3.0, 30.0}},
                                        {"scale[step(time)]", {0.1, 55.0}}};
  const SimulatedFlight flight =
      fly("magnetometer", hidden, {.rows = 300, .noise = 0.3, .seed = 3});
  for (const std::vector<std::string>& order :
       {std::vector<std::string>{"bias_step", "scale[step(time)]"},
        std::vector<std::string>{"scale[step(time)]", "bias_step"}}) {
    const Calibration calibration = calibrate_with("magnetometer", flight, order);
    CHECK(error_of(calibration, flight, "bias_step.t0") < row_interval(flight));
    CHECK(error_of(calibration, flight, "scale[step(time)].t0") < row_interval(flight));
  }
}

TEST_CASE("only effects that step have a time to be found") {
  const auto probe = make_probe_called("magnetometer");
  std::vector<EffectSetting> settings{
      {.name = "bias_step"}, {.name = "warm_up"}, {.name = "scale[step(time)]"}};
  const Flight flight = make_flight(fly("magnetometer", {}));
  const EffectiveFlight made =
      with_effects(*probe, flight, probe->prepare(flight, {}), settings, {});
  const auto times = estimation::step_times(settings, made.effects);
  REQUIRE(times.size() == 2);
  CHECK(times.at("bias_step.t0") == settings.data());
  CHECK(times.at("scale[step(time)].t0") == &settings[2]);
}

}  // namespace step_times_test
