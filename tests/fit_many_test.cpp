// SPDX-License-Identifier: BSD-3-Clause
// A joint fit against one fit of the stacked problem: all flights' rows in one record, and a model
// written here whose wind is switched by the flight's number.
#include "sepcal/fit_many.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sepcal/error.hpp"
#include "simulated_records.hpp"

using doctest::Approx;
using doctest::Contains;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using sepcal::test::Draws;

namespace {

const FiveHoleProbe probe{4.5, 4.0, {0.35, -0.1, -0.02}};
using Flights = std::vector<std::pair<std::string, Record>>;
using sepcal::Record;

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
    const auto one = probe.at<double, X>(u.head<14>(), xi2);
    Affine<X, 3, 11> z;
    z.A.setConstant(X(0.0));
    z.A.template leftCols<2>() = one.A.template leftCols<2>();
    z.A.template middleCols<3>(2 + 3 * static_cast<int>(u[14])) = one.A.template rightCols<3>();
    z.b = one.b;
    return z;
  }
};

struct Simulation {
  std::vector<std::size_t> rows{180, 260, 220};
  double correlation = 0.0;  // of a residual's neighbours
  double departure = 0.0;    // of b_alpha in the second flight
  std::uint64_t seed = 1;
};

/// Flights of a probe with lambda_va 0.08, b_va -0.7 m/s in winds that differ.
Flights simulate(const Simulation& simulation) {
  Flights flights;
  const auto model = block_model(probe);
  for (std::size_t i = 0; i < simulation.rows.size(); ++i) {
    const auto seed = 1000 * simulation.seed + i;
    auto plain = test::simulate_five_hole(simulation.rows[i], 0.0, seed);
    Record record;
    for (const Variable& input : model->tables().inputs) {
      if (!plain.record.has(input.name)) continue;
      const auto column = plain.record.column(input.name);
      record.add(input.name, {column.begin(), column.end()});
    }
    Draws draws(seed + 77);
    VectorXd xi1 = plain.xi1;
    xi1.tail(3) = 4.0 * draws.normal_matrix(3, 1);
    VectorXd xi2 = plain.xi2;
    if (i == 1) xi2[1] += simulation.departure;
    Record exact = record;
    test::add_outputs(exact, *model, xi1, xi2, VectorXd::Zero(3), draws);
    const double c = simulation.correlation;
    for (int j = 0; j < 3; ++j) {
      const auto z = exact.column(model->tables().outputs[static_cast<std::size_t>(j)].name);
      std::vector<double> noisy(z.begin(), z.end());
      double e = draws.normal();
      for (double& value : noisy) {
        value += 0.1 * (j + 1) * e;
        e = c * e + std::sqrt(1.0 - c * c) * draws.normal();
      }
      record.add(model->tables().outputs[static_cast<std::size_t>(j)].name, noisy);
    }
    flights.emplace_back("flight " + std::to_string(i), std::move(record));
  }
  return flights;
}

Record stack(const Flights& flights) {
  Record stacked;
  std::vector<Segment> segments;
  for (const std::string& name : flights.front().second.names()) {
    std::vector<double> column;
    for (const auto& [label, record] : flights) {
      const auto values = record.column(name);
      column.insert(column.end(), values.begin(), values.end());
    }
    stacked.add(name, column);
  }
  std::vector<double> number;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const std::size_t first = number.size();
    number.insert(number.end(), flights[i].second.length(), static_cast<double>(i));
    segments.push_back({flights[i].first, first, number.size()});
  }
  stacked.add("flight", number);
  stacked.cut(segments);
  return stacked;
}

ManyOptions wind_a_flight() {
  ManyOptions options;
  options.own = {"w_n", "w_e", "w_d"};
  options.fit.samples = 60;
  options.fit.threads = 1;
  return options;
}

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
  const Flights flights = simulate({});
  const Record stacked = stack(flights);
  ManyOptions options = wind_a_flight();
  SUBCASE("with R estimated") {}
  SUBCASE("with R given") { options.fit.noise = {{"vn", 0.1}, {"ve", 0.25}, {"vd", 0.3}}; }
  SUBCASE("with a bound of a shared parameter active") {
    options.fit.bounds["b_va"] = {-0.65, 2.0};
  }
  SUBCASE("with a bound of a nonlinear shared parameter active") {
    options.fit.bounds["b_alpha"] = {-0.1, 0.028};
  }
  SUBCASE("with a parameter fixed") { options.fit.fixed["lambda_beta"] = -0.1; }
  SUBCASE("on two threads") { options.fit.threads = 2; }
  const ManyFit joint = fit_many(probe, flights, options);
  check_same(joint, fit(StackedProbe{}, stacked, options.fit));
  if (options.fit.bounds.contains("b_va")) {
    CHECK(joint["b_va"].at_bound);
  }
}

TEST_CASE("a bound of a flight's own parameter may be active in one flight and not in another") {
  const Flights flights = simulate({});
  ManyOptions options = wind_a_flight();
  const ManyFit free = fit_many(probe, flights, options);
  std::vector<double> winds;
  for (const FlightFit& flight : free.flights) winds.push_back(flight.own[0].value);
  std::ranges::sort(winds);
  const double most = 0.5 * (winds[1] + winds[2]);
  options.fit.bounds["w_n"] = {-100.0, most};
  FitOptions stacked = options.fit;
  stacked.bounds.clear();
  for (const char* name : {"w_n_0", "w_n_1", "w_n_2"}) stacked.bounds[name] = {-100.0, most};
  const ManyFit joint = fit_many(probe, flights, options);
  check_same(joint, fit(StackedProbe{}, stack(flights), stacked));
  const auto held = std::ranges::count_if(
      joint.flights, [](const FlightFit& flight) { return flight.own[0].at_bound; });
  CHECK(held == 1);
}

TEST_CASE("a nonlinear parameter may be the flight's own, and all may be shared") {
  const Flights flights = simulate({});
  ManyOptions options = wind_a_flight();
  options.own = {"w_n", "w_e", "w_d", "b_alpha"};
  const ManyFit joint = fit_many(probe, flights, options);
  CHECK(joint.status == FitStatus::converged);
  for (const FlightFit& flight : joint.flights) {
    CHECK(flight.own[3].name == "b_alpha");
    CHECK(std::abs(flight.own[3].value - 0.03) < 4.0 * flight.own[3].standard_error);
  }
  CHECK(std::ranges::find(joint.shared, "b_alpha", &Parameter::name) == joint.shared.end());

  options.own.clear();
  const Fit one = fit(probe, stack(flights), options.fit);
  const ManyFit all_shared = fit_many(probe, flights, options);
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
  Flights flights = simulate({});
  const ManyOptions options = wind_a_flight();
  const ManyFit forward = fit_many(probe, flights, options);
  std::ranges::reverse(flights);
  const ManyFit backward = fit_many(probe, flights, options);
  for (std::size_t k = 0; k < forward.shared.size(); ++k) {
    check_same(backward.shared[k], forward.shared[k]);
  }
  for (const FlightFit& flight : forward.flights) {
    CHECK(backward.flight(flight.name).departure.statistic ==
          Approx(flight.departure.statistic).epsilon(1e-6));
  }
}

TEST_CASE("a flight that tells of some parameters only joins, and is tested on what it tells") {
  Flights flights = simulate({});
  // At one airspeed and without flow angles: it can't tell lambda_va from b_va, nor the scales.
  Flights poor = simulate({.rows = {50}, .seed = 9});
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
  const ManyFit joint = fit_many(probe, flights, options);
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
  Flights flights = simulate({});
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
  const ManyFit joint = fit_many(probe, flights, wind_a_flight());
  CHECK(joint.status == FitStatus::not_identifiable);
  CHECK(joint.message.find("lambda_va") != std::string::npos);
  CHECK(joint.message.find("b_va") != std::string::npos);
}

TEST_CASE("a departed flight is found, by its name and by what departed") {
  const Flights flights = simulate({.rows = {300, 300, 300, 300, 300, 300}, .departure = 0.006});
  const ManyFit joint = fit_many(probe, flights, wind_a_flight());
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
  options.fit.fixed["b"] = 0.2;
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

TEST_CASE("a flight that can't be used is named, or left out and listed") {
  Flights flights = simulate({});
  Record broken;
  for (const std::string& name : flights[1].second.names()) {
    if (name == "ve") continue;
    const auto column = flights[1].second.column(name);
    broken.add(name, {column.begin(), column.end()});
  }
  flights[1].second = broken;
  ManyOptions options = wind_a_flight();
  CHECK_THROWS_WITH_AS(fit_many(probe, flights, options),
                       Contains("flight 'flight 1' can't be used: column 've' is missing"), Error);
  options.leave_out = true;
  const ManyFit joint = fit_many(probe, flights, options);
  REQUIRE(joint.left_out.size() == 1);
  CHECK(joint.left_out[0].name == "flight 1");
  CHECK(joint.left_out[0].reason.find("'ve'") != std::string::npos);
  CHECK(joint.flights.size() == 2);
  CHECK(joint.flights[1].name == "flight 2");

  Flights without = simulate({});
  without.erase(without.begin() + 1);
  const ManyFit two = fit_many(probe, without, wind_a_flight());
  for (std::size_t k = 0; k < two.shared.size(); ++k) {
    CHECK(joint.shared[k].value == two.shared[k].value);
  }
  for (auto& flight : flights) flight.second = broken;
  CHECK_THROWS_WITH_AS(fit_many(probe, flights, options), Contains("and 2 more of 3"), Error);
}

TEST_CASE("misuse is refused in a line that names the culprit") {
  const Flights flights = simulate({});
  const auto refuse = [&](ManyOptions options, const char* text) {
    CHECK_THROWS_WITH_AS(fit_many(probe, flights, options), Contains(text), Error);
  };
  ManyOptions options = wind_a_flight();
  options.own = {"wind"};
  refuse(options, "own: there is no parameter 'wind'; the model has: lambda_va");
  options.own = {"w_n", "w_n"};
  refuse(options, "'w_n' stands there twice");
  options.own = {"w_n"};
  options.fit.fixed["w_n"] = 1.0;
  refuse(options, "own 'w_n' is fixed");
  options = wind_a_flight();
  for (const char* name :
       {"lambda_va", "b_va", "lambda_alpha", "b_alpha", "lambda_beta", "b_beta", "eps_phi"}) {
    options.own.emplace_back(name);
  }
  refuse(options, "nothing joins the flights");
  CHECK_THROWS_WITH_AS(fit_many(probe, Flights{}, wind_a_flight()), Contains("no flights"), Error);
  Flights twice = flights;
  twice[2].first = "flight 0";
  CHECK_THROWS_WITH_AS(fit_many(probe, twice, wind_a_flight()),
                       Contains("two flights are called 'flight 0'"), Error);
  const ManyFit joint = fit_many(probe, flights, wind_a_flight());
  CHECK_THROWS_WITH_AS((void)joint["w_n"], Contains("no shared parameter 'w_n'"), Error);
  CHECK_THROWS_WITH_AS((void)joint.flight("x"), Contains("no flight 'x'"), Error);
}
