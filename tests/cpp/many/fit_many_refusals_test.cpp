// SPDX-License-Identifier: BSD-3-Clause
// Flights that can't be used, and misuse: a line that names the culprit.
#include <doctest/doctest.h>

#include "sepcal/error.hpp"
#include "simulated_fleets.hpp"

namespace fit_many_refusals_test {

using doctest::Contains;
using namespace sepcal;
using test::fleet_probe;
using test::Flights;
using test::simulate_fleet;
using test::wind_a_flight;

TEST_CASE("a flight that can't be used is named, or left out and listed") {
  Flights flights = simulate_fleet({});
  Record broken;
  for (const std::string& name : flights[1].second.names()) {
    if (name == "ve") continue;
    const auto column = flights[1].second.column(name);
    broken.add(name, {column.begin(), column.end()});
  }
  flights[1].second = broken;
  ManyOptions options = wind_a_flight();
  CHECK_THROWS_WITH_AS(fit_many(fleet_probe, flights, options),
                       Contains("flight 'flight 1' can't be used: column 've' is missing"), Error);
  options.leave_out = true;
  const ManyFit joint = fit_many(fleet_probe, flights, options);
  REQUIRE(joint.left_out.size() == 1);
  CHECK(joint.left_out[0].name == "flight 1");
  CHECK(joint.left_out[0].reason.find("'ve'") != std::string::npos);
  CHECK(joint.flights.size() == 2);
  CHECK(joint.flights[1].name == "flight 2");

  Flights without = simulate_fleet({});
  without.erase(without.begin() + 1);
  const ManyFit two = fit_many(fleet_probe, without, wind_a_flight());
  for (std::size_t k = 0; k < two.shared.size(); ++k) {
    CHECK(joint.shared[k].value == two.shared[k].value);
  }
  for (auto& flight : flights) flight.second = broken;
  CHECK_THROWS_WITH_AS(fit_many(fleet_probe, flights, options), Contains("and 2 more of 3"), Error);
}

TEST_CASE("misuse is refused in a line that names the culprit") {
  const Flights flights = simulate_fleet({});
  const auto refuse = [&](ManyOptions options, const char* text) {
    CHECK_THROWS_WITH_AS(fit_many(fleet_probe, flights, options), Contains(text), Error);
  };
  ManyOptions options = wind_a_flight();
  options.fit.loss = Loss::huber;
  refuse(options, "by least squares alone, without loss 'huber'");
  options = wind_a_flight();
  options.own = {"wind"};
  refuse(options, "own: there is no parameter 'wind'; the model has: lambda_va");
  options.own = {"w_n", "w_n"};
  refuse(options, "'w_n' stands there twice");
  options.own = {"w_n"};
  options.fit.fix["w_n"] = 1.0;
  refuse(options, "own 'w_n' is fixed");
  options = wind_a_flight();
  for (const char* name :
       {"lambda_va", "b_va", "lambda_alpha", "b_alpha", "lambda_beta", "b_beta", "eps_phi"}) {
    options.own.emplace_back(name);
  }
  refuse(options, "nothing joins the flights");
  CHECK_THROWS_WITH_AS(fit_many(fleet_probe, Flights{}, wind_a_flight()), Contains("no flights"),
                       Error);
  Flights twice = flights;
  twice[2].first = "flight 0";
  CHECK_THROWS_WITH_AS(fit_many(fleet_probe, twice, wind_a_flight()),
                       Contains("two flights are called 'flight 0'"), Error);
  const ManyFit joint = fit_many(fleet_probe, flights, wind_a_flight());
  CHECK_THROWS_WITH_AS((void)joint["w_n"], Contains("no shared parameter 'w_n'"), Error);
  CHECK_THROWS_WITH_AS((void)joint.flight("x"), Contains("no flight 'x'"), Error);
}

}  // namespace fit_many_refusals_test
