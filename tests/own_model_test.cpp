// SPDX-License-Identifier: BSD-3-Clause
// A model of the user's own in C++ through the verbs: the hidden effect is found, added, saved,
// read and applied.
#include "sepcal/flight/own_model.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/adding.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/effect_catalogue.hpp"
#include "sepcal/flight/export.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"

namespace own_model_test {
namespace {

using namespace sepcal;
using doctest::Approx;

/// King's law of a hot wire, E^2 = A + B U^n.
struct HotWire {
  static constexpr std::array inputs{Quantity{"u", "m/s"}};
  static constexpr std::array outputs{Quantity{"e2", "V^2"}};
  static constexpr std::array linear{Quantity{"A", "V^2"}, Quantity{"B", "1"}};
  static constexpr std::array nonlinear{Quantity{"n", "1", 0.3, 0.7}};

  template <class U, class X>
  Affine<X, 1, 2> at(const Vec<U, 1>& u, const Vec<X, 1>& xi2) const {
    using std::exp;
    using std::log;
    Affine<X, 1, 2> z;
    z.A(0, 0) = X(1.0);
    z.A(0, 1) = exp(xi2[0] * log(u[0]));
    z.b.setZero();
    return z;
  }
};

/// `of_temperature` [1/K]: what the wire loses by a warmer air. Its noise goes on for a second.
Flight tunnel(unsigned seed, double of_temperature) {
  std::mt19937_64 draw(seed);  // NOLINT(bugprone-random-generator-seed): the same flight each time
  std::normal_distribution<double> normal;
  const std::size_t rows = 1200;
  std::vector<double> time(rows);
  std::vector<double> speed(rows);
  std::vector<double> temperature(rows);
  std::vector<double> squared(rows);
  double goes_on = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    time[i] = 0.1 * static_cast<double>(i);
    speed[i] = 15.0 + 9.0 * std::sin(time[i] / 7.0);
    temperature[i] = 20.0 + 8.0 * std::sin(time[i] / 31.0);
    goes_on = 0.9 * goes_on + 0.002 * normal(draw);
    const double clean =
        (2.0 + 1.1 * std::pow(speed[i], 0.45)) * (1.0 - of_temperature * (temperature[i] - 20.0));
    squared[i] = clean + goes_on + 0.01 * normal(draw);
  }
  Flight flight("tunnel");
  flight.add("time_s", time).add("u_mps", speed).add("temp_degc", temperature).add("e2", squared);
  return flight;
}

CalibrationOptions seeded() {
  CalibrationOptions options;
  options.fit.seed = 1;
  return options;
}

}  // namespace

TEST_CASE("an own model has the loop: a hidden effect is found, added, saved and applied") {
  const auto wire = own_model("hot-wire", HotWire{});
  const Flight flight = tunnel(1, 0.004);
  const Calibration base = calibrate(wire, flight, seeded());
  CHECK(base.fit.status == FitStatus::converged);
  const FlightDiagnosis found = diagnose(base, flight);
  REQUIRE(found.diagnosis.verdict == Verdict::effect_missing);
  const std::string effect = found.diagnosis.advice.effect;
  REQUIRE(effect.find("[temp_degc]") != std::string::npos);
  const Calibration better = add(base, flight, effect);
  const HistoryEntry& step = better.history.back();
  CHECK(1.0 - step.rmse_after / step.rmse_before == Approx(step.predicted_drop).epsilon(0.05));

  const Calibration read = parse_calibration(to_json(better), "better.json", wire);
  CHECK(to_json(read) == to_json(better));
  const Flight other = tunnel(2, 0.004);
  const auto columns = apply(read, other);
  REQUIRE(columns.size() == 1);
  CHECK(columns[0].header == "e2_fit_v2");
  double squares = 0.0;
  const auto logged = other.find("e2")->values;
  for (std::size_t i = 0; i < logged.size(); ++i) {
    squares += std::pow(logged[i] - columns[0].values[i], 2);
  }
  CHECK(std::sqrt(squares / static_cast<double>(logged.size())) ==
        Approx(compare(better, flight).overall[0].rmse).epsilon(0.2));
}

TEST_CASE("an own model without anything hidden is adequate") {
  const Flight flight = tunnel(3, 0.0);
  const Calibration base = calibrate(own_model("hot-wire", HotWire{}), flight, seeded());
  CHECK(diagnose(base, flight).diagnosis.verdict == Verdict::adequate);
  for (const auto& [name, truth] : {std::pair{"A", 2.0}, {"B", 1.1}, {"n", 0.45}}) {
    CHECK(std::abs(base.fit[name].value - truth) < 4.0 * base.fit[name].standard_error);
  }
}

TEST_CASE("an own model's catalogue has its parameters, inputs, outputs and delays") {
  std::vector<std::string> names;
  for (const CataloguedEffect& effect : effect_catalogue(*own_model("hot-wire", HotWire{}))) {
    names.push_back(effect.name);
  }
  CHECK(names == std::vector<std::string>{"A[DRIVER]", "B[DRIVER]", "u[DRIVER]", "e2_bias[DRIVER]",
                                          "e2_bias", "time_offset", "lag"});
}

TEST_CASE("what an own model can't be is said in a line") {
  CHECK_THROWS_WITH_AS(own_model("", HotWire{}), "a model of your own needs a name", Error);
  CHECK_THROWS_AS(own_model("five-hole", HotWire{}), Error);
  const auto wire = own_model("hot-wire", HotWire{});
  Flight flight = tunnel(1, 0.0);
  const Calibration base = calibrate(wire, flight, seeded());
  CHECK_THROWS_AS(parse_calibration(to_json(base), "base.json"), Error);
  CHECK_THROWS_AS(parse_calibration(to_json(base), "base.json", own_model("warm", HotWire{})),
                  Error);
  CHECK_THROWS_AS(export_calibration(base, nullptr, {}), Error);
  flight.rename("u_mps", "u_furlongs");
  CHECK_THROWS_WITH_AS(calibrate(wire, flight), doctest::Contains("column 'u_mps' is missing"),
                       Error);
}

}  // namespace own_model_test
