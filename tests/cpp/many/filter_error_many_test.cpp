// SPDX-License-Identifier: BSD-3-Clause
// Many flights by filter error against one record of as many segments: their factors against its
// own, their fit against its fit.
#include <doctest/doctest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/fit_many.hpp"
#include "sepcal/models/short_period.hpp"
#include "short_periods.hpp"
#include "simulated_fleets.hpp"
#include "trajectories.hpp"

namespace filter_error_many_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitMethod;
using sepcal::FitOptions;
using sepcal::FitStatus;
using sepcal::ManyFit;
using sepcal::Record;
using sepcal::ShortPeriod;
using sepcal::TrajectoryModel;
using sepcal::TriangularFactor;
using sepcal::test::fly_short_period;
using sepcal::test::ShortPeriodFlight;
using sepcal::test::stack;
using Flights = std::vector<std::pair<std::string, Record>>;

namespace {

/// Manoeuvres in turbulence, of unequal length and each with its start.
Flights manoeuvres() {
  Flights flights;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    ShortPeriodFlight flight;
    flight.process_noise = {0.003, 0.09};
    flight.seed = seed;
    flight.rows = 200 + 60 * seed;
    flight.start *= static_cast<double>(seed);
    flights.emplace_back("manoeuvre" + std::to_string(seed), fly_short_period(flight));
  }
  return flights;
}

FitOptions by_filter_error() {
  FitOptions options;
  options.method = FitMethod::filter_error;
  return options;
}

const std::vector<std::string> starts{"alpha_0", "q_0"};

ManyFit fit_together(const Flights& flights, const FitOptions& options) {
  return sepcal::fit_many(TrajectoryModel<ShortPeriod>(ShortPeriod{}), flights,
                          {.own = starts, .fit = options});
}

void check_same(const sepcal::Parameter& found, const sepcal::Parameter& expected) {
  INFO(expected.name);
  CHECK(std::abs(found.value - expected.value) < 1e-6 * expected.standard_error);
  CHECK(found.standard_error_white == Approx(expected.standard_error_white).epsilon(1e-6));
}

void check_same(const ManyFit& many, const Fit& one) {
  CHECK(many.status == one.status);
  CHECK(many.method == FitMethod::filter_error);
  CHECK(many.cost == Approx(one.cost).epsilon(1e-10));
  CHECK(many.log_likelihood == Approx(one.log_likelihood).epsilon(1e-10));
  CHECK(many.rows == one.rows);
  for (const auto& parameter : many.shared) {
    if (parameter.fixed) {
      CHECK(parameter.value == one[parameter.name].value);
    } else {
      check_same(parameter, one[parameter.name]);
    }
  }
  for (const auto& flight : many.flights) {
    for (const auto& parameter : flight.own) {
      check_same(parameter, one[parameter.name + "[" + flight.name + "]"]);
    }
  }
  REQUIRE(many.noise_sizes.size() == one.noise_sizes.size());
  for (std::size_t k = 0; k < many.noise_sizes.size(); ++k) {
    INFO(many.noise_sizes[k].name);
    CHECK(many.noise_sizes[k].name == one.noise_sizes[k].name);
    CHECK(many.noise_sizes[k].value == Approx(one.noise_sizes[k].value).epsilon(1e-6));
    if (std::isnan(one.noise_sizes[k].standard_error)) continue;
    CHECK(many.noise_sizes[k].standard_error ==
          Approx(one.noise_sizes[k].standard_error).epsilon(1e-6));
  }
  for (std::size_t j = 0; j < many.rmse.size(); ++j) {
    CHECK(many.rmse[j].value == Approx(one.rmse[j].value).epsilon(1e-6));
  }
}

}  // namespace

TEST_CASE("the factors of three manoeuvres, merged, are that of their record in three segments") {
  const Flights flights = manoeuvres();
  const Record stacked = stack(flights);
  const TrajectoryModel<ShortPeriod> all(ShortPeriod{}, stacked);
  const auto likelihood = all.innovations(stacked);
  const std::vector<sepcal::Variable> names = all.tables().parameters();
  const auto value_of = [](const std::string& name) {
    const std::vector<std::pair<std::string, double>> values{
        {"b_alpha", 0.02}, {"b_q", -0.01}, {"b_az", 0.5}, {"Zd", -0.35},    {"Md", -45},
        {"Za", -4.1},      {"Ma", -39},    {"Mq", -5.2},  {"alpha_0", 0.01}};
    for (const auto& [known, value] : values) {
      if (name.starts_with(known)) return value;
    }
    return -0.05;  // q_0
  };
  const auto theta_of = [&](const std::vector<sepcal::Variable>& parameters) {
    const auto n = static_cast<Index>(parameters.size());
    VectorXd theta(n + 5);
    for (Index k = 0; k < n; ++k) theta[k] = value_of(parameters[static_cast<std::size_t>(k)].name);
    theta.tail(5) << std::log(0.003), std::log(0.09), std::log(0.005), std::log(0.01),
        std::log(0.15);
    return theta;
  };
  TriangularFactor whole(static_cast<int>(likelihood->size()) + 1);
  const double cost =
      likelihood->scores(theta_of(names), [&](std::size_t, MatrixXd& rows) { whole.absorb(rows); })
          .cost;

  const TrajectoryModel<ShortPeriod> each(ShortPeriod{});
  const std::vector<sepcal::Variable> own = each.tables().parameters();
  TriangularFactor merged(whole.columns());
  double sum = 0.0;
  for (const auto& [name, record] : flights) {
    const auto part = each.innovations(record);
    TriangularFactor factor(static_cast<int>(part->size()) + 1);
    sum +=
        part->scores(theta_of(own), [&](std::size_t, MatrixXd& rows) { factor.absorb(rows); }).cost;
    MatrixXd rows = MatrixXd::Zero(factor.columns(), whole.columns());
    rows.rightCols(6) = factor.matrix().rightCols(6);
    for (std::size_t k = 0; k < own.size(); ++k) {
      const bool starts_here = own[k].name.ends_with("_0");
      const std::string in_whole = starts_here ? own[k].name + "[" + name + "]" : own[k].name;
      const auto at = std::ranges::find(names, in_whole, &sepcal::Variable::name);
      REQUIRE(at != names.end());
      rows.col(at - names.begin()) = factor.matrix().col(static_cast<Index>(k));
    }
    merged.absorb(rows);
  }
  CHECK(sum == Approx(cost).epsilon(1e-12));
  const MatrixXd difference = merged.matrix().cwiseAbs() - whole.matrix().cwiseAbs();
  CHECK(difference.norm() < 1e-12 * whole.matrix().norm());
}

TEST_CASE("three manoeuvres merged are one record in three segments" *
          doctest::test_suite("slow")) {
  const Flights flights = manoeuvres();
  const Record stacked = stack(flights);
  const TrajectoryModel<ShortPeriod> all(ShortPeriod{}, stacked);
  SUBCASE("everything free") {
    check_same(fit_together(flights, by_filter_error()),
               sepcal::fit(all, stacked, by_filter_error()));
  }
  SUBCASE("held, known before, and by the observed Hessian") {
    FitOptions options = by_filter_error();
    options.fix = {{"Mq", -5.0}};
    options.prior = {{"Zd", {-0.35, 0.05}}};
    options.process_noise = {{"q", 0.09}};
    options.hessian = sepcal::Hessian::observed;
    check_same(fit_together(flights, options), sepcal::fit(all, stacked, options));
  }
  SUBCASE("without turbulence a process noise ends at its floor") {
    Flights calm;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      ShortPeriodFlight flight;
      flight.seed = 20 + seed;
      flight.rows = 500;
      calm.emplace_back("manoeuvre" + std::to_string(seed), fly_short_period(flight));
    }
    const Record still = stack(calm);
    const TrajectoryModel<ShortPeriod> model(ShortPeriod{}, still);
    FitOptions options = by_filter_error();
    options.process_noise = {{"alpha", 1e-12}};
    const ManyFit many = fit_together(calm, options);
    const Fit one = sepcal::fit(model, still, options);
    INFO(many.message);
    CHECK(many.noise_sizes[1].at_floor == one.noise_sizes[1].at_floor);
    for (const auto& parameter : many.shared) {
      INFO(parameter.name);
      CHECK(std::abs(parameter.value - one[parameter.name].value) <
            1e-4 * one[parameter.name].standard_error);
    }
  }
}

TEST_CASE(
    "a manoeuvre of another aircraft departs from the others, and one in a gale by its noise" *
    doctest::test_suite("slow")) {
  Flights flights = manoeuvres();
  ShortPeriodFlight flight;
  flight.process_noise = {0.003, 0.09};
  flight.seed = 9;
  SUBCASE("stiffer") {
    flight.F(1, 0) = -48;
    flights.emplace_back("other", fly_short_period(flight));
    const ManyFit many = fit_together(flights, by_filter_error());
    INFO(many.message);
    CHECK(many.flight("other").departure.p_holm < 1e-3);
    const auto& departure = many.flight("other").departure;
    const auto at = std::ranges::find(departure.names, "Ma") - departure.names.begin();
    // Against the difference of the two fits, one of the others and one of its own.
    flights.pop_back();
    const ManyFit others = fit_together(flights, by_filter_error());
    const Record record = fly_short_period(flight);
    const Fit alone =
        sepcal::fit(TrajectoryModel<ShortPeriod>(ShortPeriod{}, record), record, by_filter_error());
    const double expected = alone["Ma"].value - others["Ma"].value;
    const double error =
        std::hypot(alone["Ma"].standard_error_white, others["Ma"].standard_error_white);
    CHECK(std::abs(departure.difference[at] - expected) < 0.5 * error);
    CHECK(departure.standard_error[at] == Approx(error).epsilon(0.15));
  }
  SUBCASE("in a gale") {
    flight.process_noise *= 4.0;
    flights.emplace_back("gale", fly_short_period(flight));
    const ManyFit many = fit_together(flights, by_filter_error());
    INFO(many.message);
    CHECK(many.flight("gale").departure.p_holm < 1e-6);
    const auto& departure = many.flight("gale").departure;
    const auto at = std::ranges::find(departure.names, "q_q") - departure.names.begin();
    CHECK(departure.difference[at] > 3.0 * departure.standard_error[at]);
  }
}

TEST_CASE("flights that filter error can't take") {
  const auto refused = [](FitOptions options, const std::string& words) {
    const auto fit = [&] { fit_together(manoeuvres(), options); };
    CHECK_THROWS_WITH_AS(fit(), doctest::Contains(words.c_str()), sepcal::Error);
  };
  FitOptions options = by_filter_error();
  options.loss = sepcal::Loss::huber;
  refused(options, "without loss 'huber'");
  options = by_filter_error();
  options.process_noise = {{"r", 0.1}};
  refused(options, "no process noise 'r'");
}

TEST_CASE("readings that are missing in one flight are left out" * doctest::test_suite("slow")) {
  Flights flights = manoeuvres();
  Record with_gaps;
  const Record& first = flights[0].second;
  for (const std::string name : {"time", "elevator", "airspeed", "q_m", "az_m"}) {
    with_gaps.add(name, std::vector<double>(first.column(name).begin(), first.column(name).end()));
  }
  std::vector<double> alpha(first.column("alpha_m").begin(), first.column("alpha_m").end());
  for (std::size_t row = 50; row < 200; row += 2) alpha[row] = sepcal::not_a_number;
  with_gaps.add("alpha_m", alpha);
  flights[0].second = with_gaps;
  const ManyFit many = fit_together(flights, by_filter_error());
  INFO(many.message);
  CHECK(many.status == FitStatus::converged);
  const Record stacked = stack(flights);
  const TrajectoryModel<ShortPeriod> all(ShortPeriod{}, stacked);
  check_same(many, sepcal::fit(all, stacked, by_filter_error()));
}

}  // namespace filter_error_many_test
