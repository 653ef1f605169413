// SPDX-License-Identifier: BSD-3-Clause
// Triangles of drawn flights: vehicles against the normal equations of all their rows, what is
// hidden in a fleet, in one vehicle, and where a parameter changes.
#include "sepcal/fleet.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "fleet/moderation.hpp"
#include "fleet/spread.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/error.hpp"
#include "simulated_records.hpp"

namespace fleet_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using sepcal::test::Draws;

namespace {

constexpr Index p = 2;
constexpr Index c = 3;
constexpr Index rows = 30;

struct DrawnFlight {
  MatrixXd J;
  MatrixXd G;
  VectorXd z;
};

MatrixXd draw(Draws& draws, Index count, Index columns) {
  MatrixXd drawn(count, columns);
  for (double& value : drawn.reshaped()) value = draws.normal();
  return drawn;
}

DrawnFlight draw_flight(Draws& draws, const VectorXd& theta, const VectorXd& gamma) {
  DrawnFlight flight{.J = draw(draws, rows, p), .G = draw(draws, rows, c), .z = {}};
  flight.z = flight.J * theta + flight.G * gamma + draw(draws, rows, 1);
  return flight;
}

FleetFlight reduced(const DrawnFlight& flight, const std::string& name,
                    const std::string& vehicle) {
  FlightFactor factor{.parameters = {"a", "b"}, .units = {"1", "m"}, .readings = 1.0 * rows};
  factor.values = VectorXd::Constant(p, 0.3);
  for (const char* const effect : {"e", "f", "g"}) {
    factor.columns.push_back({effect, effect, "Pa"});
  }
  MatrixXd all(rows, p + c + 1);
  all << flight.J, flight.G, flight.z - flight.J * factor.values;
  TriangularFactor triangle(static_cast<int>(all.cols()));
  triangle.absorb(all);
  factor.triangle = triangle.matrix();
  return {.name = name, .vehicle = vehicle, .factor = factor};
}

VectorXd coefficients(double second) {
  VectorXd gamma = VectorXd::Zero(c);
  gamma[1] = second;
  return gamma;
}

/// `in_last`: the second candidate's size in the last vehicle.
std::vector<FleetFlight> draw_fleet(Draws& draws, double everywhere, double in_last) {
  std::vector<FleetFlight> flights;
  for (int v = 0; v < 15; ++v) {
    const VectorXd theta = draw(draws, p, 1);
    const double size = everywhere + (v == 14 ? in_last : 0.0);
    for (int f = 0; f < 5; ++f) {
      flights.push_back(reduced(draw_flight(draws, theta, coefficients(size)),
                                std::to_string(v) + "-" + std::to_string(f),
                                "v" + std::to_string(v)));
    }
  }
  return flights;
}

}  // namespace

TEST_CASE("a vehicle's parameters are least squares of all its rows") {
  Draws draws(1);
  const VectorXd theta = draw(draws, p, 1);
  MatrixXd information = MatrixXd::Zero(p, p);
  VectorXd score = VectorXd::Zero(p);
  std::vector<FleetFlight> flights;
  for (int f = 0; f < 4; ++f) {
    const DrawnFlight flight = draw_flight(draws, theta, VectorXd::Zero(c));
    information += flight.J.transpose() * flight.J;
    score += flight.J.transpose() * flight.z;
    flights.push_back(reduced(flight, std::to_string(f), "v"));
  }
  const std::vector<VehicleFit> fits = fit_vehicles(flights);
  REQUIRE(fits.size() == 1);
  CHECK((fits[0].values - information.ldlt().solve(score)).norm() < 1e-12);
  CHECK((fits[0].covariance - information.inverse()).norm() < 1e-12);
  CHECK(fits[0].readings == 4.0 * rows);
}

TEST_CASE("a noise with a memory widens errors and moves nothing") {
  Draws draws(4);
  std::vector<FleetFlight> flights;
  for (int f = 0; f < 2; ++f) {
    flights.push_back(
        reduced(draw_flight(draws, draw(draws, p, 1), VectorXd::Zero(c)), std::to_string(f), "v"));
  }
  const VehicleFit white = fit_vehicles(flights)[0];
  for (FleetFlight& flight : flights) flight.factor.inflation = Eigen::Vector2d(4.0, 1.0);
  const VehicleFit wider = fit_vehicles(flights)[0];
  CHECK(wider.values == white.values);
  CHECK(wider.covariance(0, 0) == Approx(4.0 * white.covariance(0, 0)));
  CHECK(wider.covariance(0, 1) == Approx(2.0 * white.covariance(0, 1)));
  CHECK(wider.covariance(1, 1) == Approx(white.covariance(1, 1)));
  flights[1].factor.inflation.resize(3);
  CHECK_THROWS_WITH_AS(fit_vehicles(flights),
                       "flight '1': give an inflation for each of its parameters", Error);
}

TEST_CASE("what is hidden is found where it is") {
  Draws draws(2);
  const FleetDiagnosis nothing = diagnose(draw_fleet(draws, 0.0, 0.0));
  CHECK(nothing.found.empty());
  const FleetDiagnosis everywhere = diagnose(draw_fleet(draws, 0.2, 0.0));
  REQUIRE(everywhere.found.size() == 1);
  CHECK(everywhere.found[0].effect == "f");
  CHECK(everywhere.found[0].cause == FleetCause::everywhere);
  CHECK(everywhere.misfit_after < everywhere.misfit_before);
  const FleetDiagnosis one = diagnose(draw_fleet(draws, 0.0, 1.0));
  REQUIRE(one.found.size() == 1);
  CHECK(one.found[0].vehicle == "v14");
  CHECK(one.found[0].coefficients[0].estimate == Approx(1.0).epsilon(0.3));
}

TEST_CASE("a population is of vehicles") {
  Draws draws(3);
  const Population population = fit_population(draw_fleet(draws, 0.0, 0.0));
  CHECK(population.converged);
  CHECK(std::sqrt(population.spread(0, 0)) == Approx(1.0).epsilon(0.5));
  CHECK(population.shrunken.cols() == 15);
  CHECK((population.shrunken_errors.array() > 0.0).all());
  CHECK_THROWS_AS(fit_population({}), Error);
}

TEST_CASE("a parameter that changes is dated") {
  Draws draws(4);
  std::vector<FleetFlight> flights;
  for (int f = 0; f < 8; ++f) {
    VectorXd theta = VectorXd::Zero(p);
    theta[1] = f >= 3 ? 2.0 : 0.0;
    flights.push_back(
        reduced(draw_flight(draws, theta, VectorXd::Zero(c)), std::to_string(f), "v"));
  }
  const std::vector<VehicleSeries> series = follow_vehicles(flights);
  REQUIRE(series.size() == 1);
  CHECK(series[0].change == 3);
  CHECK(series[0].parameter == "b");
  CHECK(series[0].p_adjusted < 1e-6);
}

TEST_CASE("variances are moderated by what units have in common") {
  // Of equal variances the posterior is the pooled one; of very different ones each unit's own.
  const fleet::Moderation alike =
      fleet::moderate(std::vector<double>(10, 4.0), std::vector<double>(10, 5.0));
  CHECK(alike.pooled == 4.0);
  CHECK(std::isinf(alike.freedoms[0]));
  std::vector<double> apart;
  for (int k = 0; k < 10; ++k) apart.push_back(std::pow(10.0, k));
  const fleet::Moderation own = fleet::moderate(apart, std::vector<double>(10, 50.0));
  CHECK(own.inflations[9] == Approx(1e9).epsilon(0.05));
  CHECK(fleet::moderate({0.0}, {0.0}).inflations[0] == 1.0);
}

TEST_CASE("a spread of what is known exactly is the sample's") {
  const std::vector<double> estimates{1.0, 2.0, 4.0, 7.0};
  const fleet::Spread spread = fleet::find_spread(estimates, {1e-9, 1e-9, 1e-9, 1e-9});
  CHECK(spread.mean == Approx(3.5));
  CHECK(spread.variance == Approx(7.0));
}

}  // namespace fleet_test
