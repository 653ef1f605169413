// SPDX-License-Identifier: BSD-3-Clause
// What a joint fit says of each of its flights: what it tells and what it leaves open, and how it
// departs from the others.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulated_fleets.hpp"

namespace fit_many_flights_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::VectorXd;
using namespace sepcal;
using test::fleet_probe;
using test::Flights;
using test::simulate_fleet;
using test::wind_a_flight;

TEST_CASE("a flight that tells of some parameters only joins, and is tested on what it tells") {
  Flights flights = simulate_fleet({});
  // At one airspeed and without flow angles: it can't tell lambda_va from b_va, nor the scales.
  Flights poor = simulate_fleet({.rows = {50}, .seed = 9});
  Record straight;
  for (const std::string& name : poor.front().second.names()) {
    const auto column = poor.front().second.column(name);
    std::vector<double> values(column.begin(), column.end());
    if (name == "dpa" || name == "dpb") std::ranges::fill(values, 0.0);
    if (name == "pt") std::ranges::fill(values, 95300.0);
    if (name == "rho") std::ranges::fill(values, 1.15);
    straight.add(name, values);
  }
  flights.emplace_back("straight", straight);
  ManyOptions options = wind_a_flight();
  const ManyFit joint = fit_many(fleet_probe, flights, options);
  CHECK(joint.status != FitStatus::not_identifiable);
  const FlightFit& flight = joint.flight("straight");
  CHECK(flight.alone == FitStatus::not_identifiable);
  CHECK(flight.departure.combinations < 7);
  CHECK(flight.departure.combinations > 0);
  CHECK(flight.departure.p >= 0.0);
  // lambda_va and b_va are one number at one airspeed.
  CHECK(std::isnan(flight.departure.difference[0]));
}

TEST_CASE("what all flights leave open is named") {
  Flights flights = simulate_fleet({});
  for (auto& [name, record] : flights) {
    Record changed;
    for (const std::string& column : record.names()) {
      const auto values = record.column(column);
      std::vector<double> kept(values.begin(), values.end());
      if (column == "pt") std::ranges::fill(kept, 95300.0);
      if (column == "rho") std::ranges::fill(kept, 1.15);
      changed.add(column, kept);
    }
    record = changed;
  }
  const ManyFit joint = fit_many(fleet_probe, flights, wind_a_flight());
  CHECK(joint.status == FitStatus::not_identifiable);
  CHECK(joint.message.find("lambda_va") != std::string::npos);
  CHECK(joint.message.find("b_va") != std::string::npos);
}

TEST_CASE("a departed flight is found, by its name and by what departed") {
  const Flights flights =
      simulate_fleet({.rows = {300, 300, 300, 300, 300, 300}, .departure = 0.006});
  const ManyFit joint = fit_many(fleet_probe, flights, wind_a_flight());
  for (const FlightFit& flight : joint.flights) {
    CAPTURE(flight.name);
    const Departure& departure = flight.departure;
    if (flight.name != "flight 1") {
      CHECK(departure.p_holm > 0.01);
      continue;
    }
    CHECK(departure.combinations == 7);
    CHECK(departure.p_holm < 0.01);
    CHECK(departure.p_white_holm < 0.01);
    const VectorXd sizes = departure.difference.cwiseQuotient(departure.standard_error).cwiseAbs();
    Index largest = 0;
    sizes.maxCoeff(&largest);
    CHECK(joint.shared[static_cast<std::size_t>(largest)].name == "b_alpha");
    CHECK(std::abs(departure.difference[3] - 0.006) < 3.0 * departure.standard_error[3]);
  }
}

TEST_CASE("the white test is the drop in cost where a flight has its own shared parameters") {
  // Scalar example 1 with b held is linear: the drop is exact, F by its definition.
  Flights flights;
  ManyOptions options;
  options.own = {"c"};
  options.fit.fix["b"] = 0.2;
  options.fit.threads = 1;
  for (std::uint64_t i = 0; i < 4; ++i) {
    flights.emplace_back("wave " + std::to_string(i),
                         test::simulate_scalar_1(12 + 3 * i, 1.0, i + 5).record);
  }
  const ManyFit joint = fit_many(ScalarExample1{}, flights, options);
  const auto sum_of = [](const OutputValue& rmse, std::size_t rows) {
    return rmse.value * rmse.value * static_cast<double>(rows);
  };
  const double together = sum_of(joint.rmse[0], joint.rows);
  for (const FlightFit& flight : joint.flights) {
    Flights others = flights;
    std::erase_if(others, [&](const auto& named) { return named.first == flight.name; });
    const ManyFit rest = fit_many(ScalarExample1{}, others, options);
    const auto at = std::ranges::find(flights, flight.name, &Flights::value_type::first);
    const Fit alone = fit(ScalarExample1{}, at->second, options.fit);
    const double apart = sum_of(rest.rmse[0], rest.rows) + sum_of(alone.rmse[0], alone.rows);
    const double freedom = static_cast<double>(joint.rows) - 6.0;  // a, four c, and another a
    const double F = (together - apart) / (apart / freedom);
    // k = 1: t^2 = F; the difference over its white standard error.
    const double difference = alone["a"].value - rest["a"].value;
    CHECK(flight.departure.difference[0] == Approx(difference).epsilon(1e-9));
    // p of F(1, freedom) by quadrature of Student's density.
    double tail = 0.0;
    const double t = std::sqrt(F);
    const double constant =
        std::exp(std::lgamma(0.5 * (freedom + 1.0)) - std::lgamma(0.5 * freedom)) /
        std::sqrt(std::numbers::pi * freedom);
    constexpr int steps = 20'000;
    for (int s = 0; s < steps; ++s) {
      const double x = t * (s + 0.5) / steps;
      tail += constant * std::pow(1.0 + x * x / freedom, -0.5 * (freedom + 1.0)) * t / steps;
    }
    CHECK(flight.departure.p_white == Approx(1.0 - 2.0 * tail).epsilon(1e-6));
  }
}

}  // namespace fit_many_flights_test
