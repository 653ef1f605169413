// SPDX-License-Identifier: BSD-3-Clause
// From one calibration to the next: effects added one by one or in pairs, the history's errors
// against those of compare(), and what is refused.

#include <cmath>

#include "flights_with_effects.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"

namespace adding_test {

using namespace sepcal;
using namespace sepcal::test;
using Texts = std::vector<std::string>;

namespace {

const SizedEffect shear{"wind[altitude_m]", {0.02, -0.03}};
const SizedEffect loss{"airspeed_scale[alpha^2]", {-0.8}};

SimulatedFlight fly_both(double noise = 0.1, std::size_t rows = 400) {
  return fly("five-hole", {shear, loss}, {.rows = rows, .noise = noise, .seed = 11});
}

/// The root of all squared residuals of compare() over their number, in rows at least `margin` [s]
/// from every segment's edge: the times of the rows that `like` used.
double rmse_on_rows_of(const Comparison& like, const Comparison& comparison) {
  double square = 0.0;
  std::size_t row = 0;
  for (const double time : like.time) {
    while (comparison.time[row] < time) ++row;
    REQUIRE(comparison.time[row] == time);
    square += comparison.residuals.row(static_cast<Eigen::Index>(row)).squaredNorm();
  }
  return std::sqrt(square / (3.0 * static_cast<double>(like.time.size())));
}

Texts effect_names(const Calibration& calibration) {
  Texts names;
  for (const EffectSetting& setting : calibration.options.effects) names.push_back(setting.name);
  return names;
}

}  // namespace

TEST_CASE("a chain of two effects: the errors of its history are those of compare()") {
  const SimulatedFlight simulated = fly_both();
  const Flight flight = make_flight(simulated);
  const Calibration base = calibrate_with("five-hole", simulated, {});
  const Calibration one = add(base, flight, "wind[altitude_m]");
  const Calibration two = add(one, flight, "airspeed_scale[alpha^2]");
  REQUIRE(two.history.size() == 2);
  CHECK(one.history.size() == 1);
  CHECK(two.history[0].effect == "wind[altitude_m]");
  CHECK(two.history[1].effect == "airspeed_scale[alpha^2]");
  CHECK(effect_names(two) == Texts{"wind[altitude_m]", "airspeed_scale[alpha^2]"});
  CHECK(compare_with(base, flight, "wind[altitude_m]").residuals == compare(one, flight).residuals);

  const Comparison of_base = compare(base, flight);
  const Comparison of_one = compare(one, flight);
  const Comparison of_two = compare(two, flight);
  const auto check = [](double rmse, const Comparison& expected) {
    CHECK(rmse == doctest::Approx(rmse_on_rows_of(expected, expected)).epsilon(1e-12));
  };
  check(two.history[0].rmse_before, of_base);
  check(two.history[0].rmse_after, of_one);
  check(two.history[1].rmse_before, of_one);
  check(two.history[1].rmse_after, of_two);
  CHECK(two.history[0].rmse_after < 0.8 * two.history[0].rmse_before);
  CHECK(std::abs(two.history[1].rmse_after / 0.1 - 1.0) < 0.1);  // the noise
  for (const HistoryEntry& entry : two.history) {
    const double achieved = 1.0 - entry.rmse_after / entry.rmse_before;
    CHECK(entry.predicted_drop == doctest::Approx(achieved).epsilon(0.05));
    CHECK(entry.held_out_before == doctest::Approx(entry.rmse_before).epsilon(0.1));
    CHECK(entry.held_out_after < entry.held_out_before);
  }
}

TEST_CASE("an effect added is the same as one fitted at once") {
  const SimulatedFlight simulated = fly_both();
  const Calibration base = calibrate_with("five-hole", simulated, {"wind[altitude_m]"});
  const Calibration added = add(base, make_flight(simulated), "airspeed_scale[alpha^2]");
  const Calibration at_once =
      calibrate_with("five-hole", simulated, {"wind[altitude_m]", "airspeed_scale[alpha^2]"});
  REQUIRE(added.fit.parameters.size() == at_once.fit.parameters.size());
  for (std::size_t k = 0; k < added.fit.parameters.size(); ++k) {
    const Parameter& parameter = at_once.fit.parameters[k];
    CAPTURE(parameter.name);
    CHECK(added.fit.parameters[k].name == parameter.name);
    CHECK(std::abs(added.fit.parameters[k].value - parameter.value) <
          1e-6 * parameter.standard_error);
  }
}

TEST_CASE("both errors are of the rows that the new fit used") {
  const SimulatedFlight simulated = fly_both(0.1, 2400);
  const Flight flight = make_flight(simulated);
  const Calibration base = calibrate_with("five-hole", simulated, {});
  const Calibration late = add(base, flight, "time_offset");
  const Comparison of_base = compare(base, flight);
  const Comparison of_late = compare(late, flight);
  REQUIRE(of_late.time.size() < of_base.time.size());
  CHECK(late.history[0].rmse_before ==
        doctest::Approx(rmse_on_rows_of(of_late, of_base)).epsilon(1e-12));
  CHECK(late.history[0].rmse_after ==
        doctest::Approx(rmse_on_rows_of(of_late, of_late)).epsilon(1e-12));
}

TEST_CASE("a pair is one entry, in the order given; an alias is called by its meaning") {
  const SimulatedFlight simulated = fly_both();
  const Flight flight = make_flight(simulated);
  const Calibration base = calibrate_with("five-hole", simulated, {});
  const Calibration pair = add(base, flight, "airspeed_scale[alpha^2] + wind_shear");
  REQUIRE(pair.history.size() == 1);
  CHECK(pair.history[0].effect == "airspeed_scale[alpha^2]+wind[altitude_m]");
  CHECK(effect_names(pair) == Texts{"airspeed_scale[alpha^2]", "wind[altitude_m]"});
  const Calibration chain =
      add(add(base, flight, "wind[altitude_m]"), flight, "airspeed_scale[alpha^2]");
  CHECK(pair.fit.cost == doctest::Approx(chain.fit.cost).epsilon(1e-9));
  CHECK(pair.fit["wind[altitude_m].n"].value ==
        doctest::Approx(chain.fit["wind[altitude_m].n"].value).epsilon(1e-6));
}

TEST_CASE("the calibration that is added to may come from JSON, and its result goes there") {
  const SimulatedFlight simulated = fly_both();
  const Flight flight = make_flight(simulated);
  const Calibration one = add(calibrate_with("five-hole", simulated, {}), flight, "wind_shear");
  const Calibration read = parse_calibration(to_json(one), "one.json");
  const Calibration two = add(one, flight, "airspeed_scale[alpha^2]");
  const Calibration from_read = add(read, flight, "airspeed_scale[alpha^2]");
  CHECK(to_json(from_read) == to_json(two));
  CHECK(to_json(parse_calibration(to_json(two), "two.json")) == to_json(two));
}

TEST_CASE("a step's time that was found stays when another effect joins") {
  const SimulatedFlight simulated =
      fly("magnetometer", {{"bias_step", {2.0, -1.0, 3.0}}, {"scale[step(time)]", {0.1, 60.0}}},
          {.rows = 300, .noise = 0.3, .seed = 4});
  const Flight flight = make_flight(simulated);
  const Calibration step = add(calibrate_with("magnetometer", simulated, {}), flight, "bias_step");
  const Calibration both = add(step, flight, "scale[step(time)]");
  CHECK(both.fit["bias_step.t0"].value == step.fit["bias_step.t0"].value);
  CHECK(std::abs(both.fit["scale[step(time)].t0"].value - 60.0) < 0.5);
  CHECK(both.fit["bias_step.t0"].fixed);
}

TEST_CASE("so does one of a model without linear parameters") {
  const SimulatedFlight simulated =
      fly("magnetometer-norm", {{"bias_step", {2.0, -1.0, 3.0}}, {"scale[current_a]", {0.005}}},
          {.rows = 300, .noise = 0.1, .seed = 4});
  const Flight flight = make_flight(simulated);
  const Calibration step =
      add(calibrate_with("magnetometer-norm", simulated, {}), flight, "bias_step");
  const Calibration both = add(step, flight, "scale[current_a]");
  CHECK(both.fit["bias_step.t0"].value == step.fit["bias_step.t0"].value);
  CHECK(both.history.back().rmse_after < 0.8 * both.history.back().rmse_before);
  CHECK(std::abs(both.fit["scale[current_a].s"].value - 0.005) <
        5.0 * both.fit["scale[current_a].s"].standard_error);
}

TEST_CASE("an effect that is there already is refused, by its name or an alias") {
  const SimulatedFlight simulated = fly_both();
  const Flight flight = make_flight(simulated);
  const Calibration base = calibrate_with("five-hole", simulated, {"wind[altitude_m]"});
  for (const char* again : {"wind[altitude_m]", "wind[ altitude_m ]", "wind_shear",
                            "heading_bias+heading_bias", "heading_bias+wind_shear"}) {
    CAPTURE(again);
    check_refused([&] { add(base, flight, again); }, {"effect"});
  }
  check_refused([&] { add(base, flight, "wind[altitude_m]"); },
                {"the calibration has the effect wind[altitude_m] already"});
  check_refused([&] { add(base, flight, "wind_shear"); }, {"wind[altitude_m]"});
}

TEST_CASE("what is no effect or no driver here is refused and names it") {
  const SimulatedFlight simulated = fly_both();
  const Flight flight = make_flight(simulated);
  const Calibration base = calibrate_with("five-hole", simulated, {});
  check_refused([&] { add(base, flight, "lift"); }, {"flight: there is no effect 'lift'"});
  check_refused([&] { add(base, flight, "wind[flaps]"); }, {"effect wind[flaps]", "'flaps'"});
  check_refused([&] { add(base, flight, "wind[time]+"); }, {"a name is missing beside '+'"});
  check_refused([&] { add(base, flight, ""); }, {"a name is missing"});
}

}  // namespace adding_test
