// SPDX-License-Identifier: BSD-3-Clause
// A model of the user's own in C++ through the verbs: the hidden effect is found, added, saved,
// read and applied.
#include "sepcal/flight/own_model.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sepcal/detail/flight/effect_catalogue.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/apply.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/export.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"
#include "sepcal/flight/own_state_model.hpp"

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

/// Roll damping and aileron effectiveness, p' = Lp p + La aileron.
struct RollMode {
  static constexpr std::array inputs{Quantity{"aileron", "rad"}};
  static constexpr std::array states{Quantity{"p", "rad/s"}};
  static constexpr std::array outputs{Quantity{"p_m", "rad/s"}};
  static constexpr std::array linear{Quantity{"b_p", "rad/s"}};
  static constexpr std::array nonlinear{Quantity{"Lp", "1/s", -20, 0}, Quantity{"La", "1/s^2"}};
  static constexpr std::array<std::string_view, 1> linear_dynamic{"La"};
  static constexpr std::array<Quantity, 0> noise{};

  template <class U, class X>
  Rate<X, 1> rate(const Vec<X, 1>& x, const Vec<U, 1>& u, const Vec<X, 2>& p) const {
    Rate<X, 1> dx;
    dx[0] = p[0] * x[0] + p[1] * u[0];
    return dx;
  }

  template <class U, class X>
  Affine<X, 1, 1> at(const Vec<X, 1>& x, const Vec<U, 1>& /*u*/, const Vec<X, 2>& /*p*/) const {
    Affine<X, 1, 1> z;
    z.A << X(1.0);
    z.b << x[0];
    return z;
  }
};

/// By the closed form of each straight piece of the aileron; the gyro's zero warms by
/// `of_temperature` [rad/s/K]. Rows from `second` on are of another maneuver.
Flight rolls(unsigned seed, double of_temperature, std::size_t second = 0) {
  constexpr double Lp = -2.5;
  constexpr double La = 8.0;
  constexpr double dt = 0.02;
  std::mt19937_64 draw(seed);  // NOLINT(bugprone-random-generator-seed): the same flight each time
  std::normal_distribution<double> normal;
  const std::size_t rows = 800;
  std::vector<double> time(rows);
  std::vector<double> aileron(rows);
  std::vector<double> temperature(rows);
  std::vector<double> rate(rows);
  std::vector<std::string> labels(rows, "first");
  for (std::size_t i = 0; i < rows; ++i) {
    time[i] = dt * static_cast<double>(i);
    aileron[i] = 0.1 * std::sin(2.1 * time[i]) + 0.05 * std::sin(5.3 * time[i] + 1.0);
    temperature[i] = 20.0 + 5.0 * std::sin(0.7 * time[i]);
    if (second > 0 && i >= second) labels[i] = "second";
  }
  double p = 0.2;
  for (std::size_t i = 0; i < rows; ++i) {
    rate[i] = p + 0.03 + of_temperature * (temperature[i] - 20.0) + 0.004 * normal(draw);
    if (i + 1 == rows) break;
    const double slope = (aileron[i + 1] - aileron[i]) / dt;
    const auto forced = [&](double t) {  // where the rate would stay
      return -La / Lp * (aileron[i] + slope * t) - La / (Lp * Lp) * slope;
    };
    p = forced(dt) + (p - forced(0.0)) * std::exp(Lp * dt);
  }
  Flight flight("rolls_" + std::to_string(seed));
  flight.add("time_s", time).add("aileron_rad", aileron).add("temp_degc", temperature);
  flight.add("p_m_radps", rate);
  if (second > 0) flight.label(labels);
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

TEST_CASE("an own model with a state has the loop too") {
  const auto roll = own_model("roll", RollMode{});
  const Flight flight = rolls(1, 0.01);
  const Calibration base = calibrate(roll, flight, seeded());
  CHECK(base.fit.status == FitStatus::converged);
  const FlightDiagnosis found = diagnose(base, flight);
  REQUIRE(found.diagnosis.verdict == Verdict::effect_missing);
  CHECK(found.diagnosis.effects.front().name.find("[temp_degc]") != std::string::npos);
  const Calibration better = add(base, flight, "b_p[temp_degc]");
  const HistoryEntry& step = better.history.back();
  CHECK(1.0 - step.rmse_after / step.rmse_before == Approx(step.predicted_drop).epsilon(0.05));
  for (const auto& [name, truth] :
       {std::pair{"Lp", -2.5}, {"La", 8.0}, {"b_p[temp_degc].s", 0.01}, {"p_0", 0.2}}) {
    CHECK(std::abs(better.fit[name].value - truth) < 4.0 * better.fit[name].standard_error);
  }
  const Calibration read = parse_calibration(to_json(better), "better.json", roll);
  CHECK(to_json(read) == to_json(better));
  const double rmse = compare(read, flight).overall[0].rmse;
  CHECK(rmse == Approx(0.004).epsilon(0.1));

  SUBCASE("another flight's initial states are estimated anew, and all else is held") {
    const Flight other = rolls(2, 0.01, 300);
    const Comparison compared = compare(read, other);
    CHECK(compared.overall[0].rmse == Approx(0.004).epsilon(0.1));
    CHECK(compared.where.size() == 2);
    const auto columns = apply(read, other);
    REQUIRE(columns.size() == 1);
    CHECK(columns[0].header == "p_m_fit_radps");
    CHECK(std::abs(columns[0].values[0] - 0.23) < 0.02);
  }
}

TEST_CASE("of an own model with a state each segment has an initial state, and no effect is one") {
  const auto roll = own_model("roll", RollMode{});
  const Calibration base = calibrate(roll, rolls(3, 0.0, 300), seeded());
  CHECK(base.fit["p_0[first]"].value == Approx(0.2).epsilon(0.1));
  CHECK(base.fit["p_0[second]"].standard_error > 0.0);
  CHECK(diagnose(base, rolls(3, 0.0, 300)).diagnosis.verdict == Verdict::adequate);
  std::vector<std::string> names;
  for (const CataloguedEffect& effect : effect_catalogue(*roll)) names.push_back(effect.name);
  CHECK(names == std::vector<std::string>{"b_p[DRIVER]", "aileron[DRIVER]", "p_m_bias[DRIVER]",
                                          "p_m_bias", "aileron_late", "aileron_lag"});
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
  flight.drop("u_mps");
  CHECK_THROWS_WITH_AS(calibrate(wire, flight), doctest::Contains("column 'u_mps' is missing"),
                       Error);
}

}  // namespace own_model_test
