// SPDX-License-Identifier: BSD-3-Clause
// A joint fit against one fit of the stacked problem: all flights' rows in one record, and a model
// written here whose wind is switched by the flight's number.
#include "sepcal/fit_many.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "simulated_fleets.hpp"

namespace fit_many_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using namespace sepcal;
using sepcal::test::Draws;
using test::fleet_probe;
using test::Flights;
using test::simulate_fleet;
using test::wind_a_flight;

namespace {

/// Three flights of the same probe, each in a wind of its own.
struct StackedProbe {
  static constexpr auto inputs = [] {
    std::array<Quantity, FiveHoleProbe::inputs.size() + 1> all{};
    std::ranges::copy(FiveHoleProbe::inputs, all.begin());
    all.back() = {"flight", "1"};
    return all;
  }();
  static constexpr auto outputs = FiveHoleProbe::outputs;
  static constexpr std::array linear{
      Quantity{"lambda_va", "1"}, Quantity{"b_va", "m/s"},  Quantity{"w_n_0", "m/s"},
      Quantity{"w_e_0", "m/s"},   Quantity{"w_d_0", "m/s"}, Quantity{"w_n_1", "m/s"},
      Quantity{"w_e_1", "m/s"},   Quantity{"w_d_1", "m/s"}, Quantity{"w_n_2", "m/s"},
      Quantity{"w_e_2", "m/s"},   Quantity{"w_d_2", "m/s"}};
  static constexpr auto nonlinear = FiveHoleProbe::nonlinear;

  template <class X>
  Affine<X, 3, 11> at(const Vec<double, 15>& u, const Vec<X, 5>& xi2) const {
    const auto one = fleet_probe.at<double, X>(u.head<14>(), xi2);
    Affine<X, 3, 11> z;
    z.A.setConstant(X(0.0));
    z.A.template leftCols<2>() = one.A.template leftCols<2>();
    z.A.template middleCols<3>(2 + 3 * static_cast<int>(u[14])) = one.A.template rightCols<3>();
    z.b = one.b;
    return z;
  }
};

/// Of one parameter, to 1e-9 standard errors; its error to 1e-7.
void check_same(const Parameter& found, const Parameter& expected) {
  CAPTURE(found.name);
  CHECK(found.at_bound == expected.at_bound);
  CHECK(found.fixed == expected.fixed);
  if (expected.fixed) {
    CHECK(found.value == expected.value);
    CHECK(std::isnan(found.standard_error));
    return;
  }
  const double scale = expected.at_bound ? 1e-9 : expected.standard_error_white;
  CHECK(std::abs(found.value - expected.value) <= 1e-9 * scale + 1e-15);
  if (expected.at_bound) {
    CHECK(std::isnan(found.standard_error));
    CHECK(std::isnan(found.standard_error_white));
    return;
  }
  CHECK(found.standard_error_white == Approx(expected.standard_error_white).epsilon(1e-7));
}

void check_same(const ManyFit& joint, const Fit& stacked) {
  CHECK(joint.status == FitStatus::converged);
  CHECK(stacked.status == FitStatus::converged);
  CHECK(joint.cost == Approx(stacked.cost).epsilon(1e-12));
  CHECK(joint.rows == stacked.rows);
  for (std::size_t j = 0; j < 3; ++j) {
    CHECK(joint.noise[j].value == Approx(stacked.noise[j].value).epsilon(1e-10));
    CHECK(joint.rmse[j].value == Approx(stacked.rmse[j].value).epsilon(1e-10));
  }
  std::vector<Index> places;
  for (const Parameter& parameter : joint.shared) {
    check_same(parameter, stacked[parameter.name]);
    const auto at = std::ranges::find(stacked.parameters, parameter.name, &Parameter::name);
    places.push_back(at - stacked.parameters.begin());
  }
  for (std::size_t i = 0; i < joint.flights.size(); ++i) {
    for (const Parameter& own : joint.flights[i].own) {
      check_same(own, stacked[own.name + "_" + std::to_string(i)]);
    }
  }
  const MatrixXd expected = stacked.covariance_white(places, places);
  for (Index a = 0; a < expected.rows(); ++a) {
    for (Index b = 0; b < expected.cols(); ++b) {
      if (std::isnan(expected(a, b))) {
        CHECK(std::isnan(joint.covariance_white(a, b)));
      } else {
        const double size = std::sqrt(expected(a, a) * expected(b, b));
        CHECK(std::abs(joint.covariance_white(a, b) - expected(a, b)) <= 1e-7 * size);
      }
    }
  }
}

}  // namespace

TEST_CASE("a joint fit of three flights is one fit of the stacked problem") {
  const Flights flights = simulate_fleet({});
  const Record stacked = test::stack(flights, "flight");
  ManyOptions options = wind_a_flight();
  SUBCASE("with R estimated") {}
  SUBCASE("with R given") { options.fit.noise = {{"vn", 0.1}, {"ve", 0.25}, {"vd", 0.3}}; }
  SUBCASE("with a bound of a shared parameter active") {
    options.fit.bounds["b_va"] = {-0.65, 2.0};
  }
  SUBCASE("with a bound of a nonlinear shared parameter active") {
    options.fit.bounds["b_alpha"] = {-0.1, 0.028};
  }
  SUBCASE("with a parameter fixed") { options.fit.fix["lambda_beta"] = -0.1; }
  SUBCASE("on two threads") { options.fit.threads = 2; }
  const ManyFit joint = fit_many(fleet_probe, flights, options);
  check_same(joint, fit(StackedProbe{}, stacked, options.fit));
  if (options.fit.bounds.contains("b_va")) {
    CHECK(joint["b_va"].at_bound);
  }
}

TEST_CASE("a bound of a flight's own parameter may be active in one flight and not in another") {
  const Flights flights = simulate_fleet({});
  ManyOptions options = wind_a_flight();
  const ManyFit free = fit_many(fleet_probe, flights, options);
  std::vector<double> winds;
  for (const FlightFit& flight : free.flights) winds.push_back(flight.own[0].value);
  std::ranges::sort(winds);
  const double most = 0.5 * (winds[1] + winds[2]);
  options.fit.bounds["w_n"] = {-100.0, most};
  FitOptions stacked = options.fit;
  stacked.bounds.clear();
  for (const char* name : {"w_n_0", "w_n_1", "w_n_2"}) stacked.bounds[name] = {-100.0, most};
  const ManyFit joint = fit_many(fleet_probe, flights, options);
  check_same(joint, fit(StackedProbe{}, test::stack(flights, "flight"), stacked));
  const auto held = std::ranges::count_if(
      joint.flights, [](const FlightFit& flight) { return flight.own[0].at_bound; });
  CHECK(held == 1);
}

TEST_CASE("the prior of a shared parameter counts once, of an own one in every flight") {
  const Flights flights = simulate_fleet({});
  ManyOptions options = wind_a_flight();
  SUBCASE("of a linear and a nonlinear shared one") {
    options.fit.prior = {{"lambda_va", {0.06, 0.01}}, {"eps_phi", {0.0, 0.02}}};
  }
  SUBCASE("of an own one") { options.fit.prior = {{"w_d", {0.5, 0.05}}}; }
  SUBCASE("of both, with R given") {
    options.fit.prior = {{"b_va", {-0.5, 0.1}}, {"w_e", {0.0, 0.3}}};
    options.fit.noise = {{"vn", 0.1}, {"ve", 0.25}, {"vd", 0.3}};
  }
  SUBCASE("of one that a bound holds") {
    options.fit.prior = {{"b_va", {-0.5, 0.1}}, {"w_d", {0.5, 0.05}}};
    options.fit.bounds["b_va"] = {-0.4, 2.0};
  }
  FitOptions stacked = options.fit;
  for (const std::string& name : options.own) {
    const auto prior = stacked.prior.find(name);
    if (prior == stacked.prior.end()) continue;
    for (const char* flight : {"_0", "_1", "_2"}) {
      stacked.prior[name + flight] = prior->second;
    }
    stacked.prior.erase(prior);
  }
  const ManyFit joint = fit_many(fleet_probe, flights, options);
  check_same(joint, fit(StackedProbe{}, test::stack(flights, "flight"), stacked));
  options.fit.prior.clear();
  const ManyFit ignorant = fit_many(fleet_probe, flights, options);
  const FlightFit& first = joint.flights.front();
  CHECK((joint.shared[1].value != ignorant.shared[1].value ||
         first.own[2].value != ignorant.flights.front().own[2].value));
}

TEST_CASE("a nonlinear parameter may be the flight's own, and all may be shared") {
  const Flights flights = simulate_fleet({});
  ManyOptions options = wind_a_flight();
  options.own = {"w_n", "w_e", "w_d", "b_alpha"};
  const ManyFit joint = fit_many(fleet_probe, flights, options);
  CHECK(joint.status == FitStatus::converged);
  for (const FlightFit& flight : joint.flights) {
    CHECK(flight.own[3].name == "b_alpha");
    CHECK(std::abs(flight.own[3].value - 0.03) < 4.0 * flight.own[3].standard_error);
  }
  CHECK(std::ranges::find(joint.shared, "b_alpha", &Parameter::name) == joint.shared.end());

  options.own.clear();
  const Fit one = fit(fleet_probe, test::stack(flights, "flight"), options.fit);
  const ManyFit all_shared = fit_many(fleet_probe, flights, options);
  for (const Parameter& parameter : all_shared.shared) check_same(parameter, one[parameter.name]);
}

TEST_CASE("one flight is fit(), its errors for coloured residuals too") {
  // Slow drivers, to which it matters that neighbouring residuals correlate.
  Draws draws(4);
  std::vector<double> eta;
  std::vector<double> z;
  double e = draws.normal();
  for (int k = 0; k < 800; ++k) {
    eta.push_back(0.02 * k);
    z.push_back(1.3 * std::cos(eta.back() + 0.2) - 0.4 + 0.1 * e);
    e = 0.8 * e + 0.6 * draws.normal();
  }
  Record record;
  record.add("eta", eta).add("z", z);
  ManyOptions options;
  options.own = {"c"};
  options.fit.threads = 1;
  SUBCASE("without a prior") {}
  SUBCASE("priors of both") { options.fit.prior = {{"a", {0.25, 0.02}}, {"c", {-0.5, 0.03}}}; }
  const Fit alone = fit(ScalarExample1{}, record, options.fit);
  const ManyFit joint = fit_many(ScalarExample1{}, {{"wave", record}}, options);
  REQUIRE(alone["a"].standard_error > 1.5 * alone["a"].standard_error_white);
  const auto check = [&](const Parameter& parameter) {
    check_same(parameter, alone[parameter.name]);
    CHECK(parameter.standard_error == Approx(alone[parameter.name].standard_error).epsilon(1e-3));
  };
  for (const Parameter& parameter : joint.shared) check(parameter);
  for (const Parameter& parameter : joint.flights.front().own) check(parameter);
  CHECK(joint.correlation(0, 1) == Approx(alone.correlation(0, 2)).epsilon(1e-3));
  CHECK(std::isnan(joint.flights.front().departure.p));
  CHECK(joint.flights.front().departure.combinations == 0);
}

TEST_CASE("the order of the flights is irrelevant to rounding") {
  Flights flights = simulate_fleet({});
  const ManyOptions options = wind_a_flight();
  const ManyFit forward = fit_many(fleet_probe, flights, options);
  std::ranges::reverse(flights);
  const ManyFit backward = fit_many(fleet_probe, flights, options);
  for (std::size_t k = 0; k < forward.shared.size(); ++k) {
    check_same(backward.shared[k], forward.shared[k]);
  }
  for (const FlightFit& flight : forward.flights) {
    CHECK(backward.flight(flight.name).departure.statistic ==
          Approx(flight.departure.statistic).epsilon(1e-6));
  }
}

}  // namespace fit_many_test
