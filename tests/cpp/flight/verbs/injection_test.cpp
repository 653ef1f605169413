// SPDX-License-Identifier: BSD-3-Clause
// Effects put into the measurements of a clean flight: would they have been found?
#include <cmath>
#include <nlohmann/json.hpp>

#include "diagnosed_flights.hpp"

namespace injection_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;

namespace {

struct Clean {
  SimulatedFlight simulated;
  Flight flight;
  Calibration base;

  explicit Clean(std::string_view probe, double noise = 0.15,
                 const std::vector<std::string>& effects = {})
      : simulated(fly(probe, {}, {.noise = noise, .seed = 21})),
        flight(make_flight(simulated)),
        base(calibrate_with(probe, simulated, effects)) {}

  FlightDiagnosis with(const SizedEffect& effect) const {
    return diagnose_with(effect, base, flight, {}, quick_diagnosis(base.probe->name()));
  }
};

}  // namespace

TEST_CASE("a large effect would have been found, at its size; a tiny one would not") {
  struct Case {
    const char* probe;
    SizedEffect large;
    double noise;
  };
  for (const auto& [probe, large, noise] :
       {Case{"five-hole", {"wind[altitude_m]", {0.012, -0.018}}, 0.15},
        Case{"pitot-static", {"wind[time]", {0.02, -0.03}}, 0.15},
        Case{"magnetometer", {"bias[current_a]", {0.05}}, 0.3}}) {
    CAPTURE(probe);
    const Clean clean(probe, noise);
    const FlightDiagnosis found = clean.with(large);
    REQUIRE(found.injection.has_value());
    CHECK(found.injection->effect == large.name);
    CHECK(found.injection->found);
    CHECK(found.injection->rank == 1);
    CHECK(found.injection->p_adjusted < 0.05);
    CHECK(found.diagnosis.verdict == Verdict::effect_missing);
    REQUIRE(found.injection->estimate.size() == found.injection->sizes.size());
    for (std::size_t k = 0; k < found.injection->sizes.size(); ++k) {
      const Coefficient& coefficient = found.injection->estimate[k];
      CHECK(std::abs(coefficient.estimate - found.injection->sizes[k]) <
            4.5 * coefficient.standard_error);
    }

    SizedEffect tiny = large;
    for (double& size : tiny.sizes) size *= 0.02;
    const FlightDiagnosis missed = clean.with(tiny);
    CHECK_FALSE(missed.injection->found);
    CHECK(missed.injection->p_adjusted > 0.05);
  }
}

TEST_CASE("one size is given to every coefficient, and an alias to what it stands for") {
  const Clean clean("magnetometer", 0.3);
  const FlightDiagnosis result = clean.with({"bias_drift", {0.2}});
  CHECK(result.injection->effect == "bias[time]");
  CHECK(result.injection->sizes == std::vector<double>{0.2, 0.2, 0.2});
  CHECK(result.injection->found);
  const auto json = nlohmann::json::parse(to_json(result));
  CHECK(json.at("injected").at("effect") == "bias[time]");
  CHECK(json.at("injected").at("found") == true);
}

TEST_CASE("the measurements change by the effect alone: a drift of the bias, in closed form") {
  const Clean clean("magnetometer", 0.3);
  SimulatedFlight shifted = clean.simulated;
  const std::vector<double> time = clean.simulated.column("time_s");
  double mean = 0.0;
  for (const double t : time) mean += t / static_cast<double>(time.size());
  for (SimulatedColumn& column : shifted.columns) {
    if (column.name != "mx_ut") continue;
    for (std::size_t i = 0; i < time.size(); ++i) column.values[i] += 0.05 * (time[i] - mean);
  }
  const Calibration again = calibrate_with("magnetometer", shifted, {});
  const FlightDiagnosis expected =
      diagnose(again, make_flight(shifted), {}, quick_diagnosis("magnetometer"));
  const FlightDiagnosis found = clean.with({"bias[time]", {0.05, 0.0, 0.0}});
  CHECK(found.diagnosis.rmse == Approx(expected.diagnosis.rmse).epsilon(1e-6));
  CHECK(find(found, "bias[time]").coefficients[0].estimate ==
        Approx(find(expected, "bias[time]").coefficients[0].estimate).epsilon(0.01));
}

TEST_CASE("what the flight can't show is not found, whatever its size, and has no rank") {
  const Clean clean("five-hole");
  const FlightDiagnosis result = clean.with({"mounting_error", {0.03, -0.02}});
  CHECK_FALSE(result.injection->found);
  CHECK(result.injection->rank == 0);
  CHECK(nlohmann::json::parse(to_json(result)).at("injected").at("rank").is_null());
}

TEST_CASE("a step's time is a size as well, the last") {
  const Clean clean("magnetometer", 0.3);
  const FlightDiagnosis result = clean.with({"bias_step", {1.0, -1.0, 1.0, 40.0}});
  CHECK(result.injection->found);
  CHECK(find(result, "bias_step").shapes.at("bias_step.t0") == Approx(40.0).epsilon(0.06));
}

TEST_CASE("what can't be injected is refused") {
  const Clean clean("five-hole", 0.15, {"wind[altitude_m]"});
  const auto refused = [&](const SizedEffect& effect,
                           std::initializer_list<std::string_view> words) {
    check_refused([&] { clean.with(effect); }, words);
  };
  refused({"lift", {1.0}}, {"there is no effect 'lift'"});
  refused({"wind[engine_2]", {1.0}}, {"wind[engine_2]", "no channel 'engine_2'"});
  refused({"wind[time]", {1.0, 2.0, 3.0}},
          {"inject wind[time]", "3 sizes", "wind[time].n, wind[time].e"});
  refused({"wind[time]", {}}, {"inject wind[time]", "0 sizes"});
  refused({"wind_shear", {0.1}}, {"has the effect wind[altitude_m] already"});
}

}  // namespace injection_test
