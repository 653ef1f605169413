// SPDX-License-Identifier: BSD-3-Clause
// Output error: the short period from no start by superposition, jointly, over several maneuvers,
// and of an aircraft that is unstable.
#include <doctest/doctest.h>

#include <cmath>

#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/fit_many.hpp"
#include "sepcal/models/short_period.hpp"
#include "short_periods.hpp"
#include "simulated_fleets.hpp"
#include "trajectories.hpp"

namespace output_error_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::FitStatus;
using sepcal::Record;
using sepcal::ShortPeriod;
using sepcal::TrajectoryModel;
using sepcal::test::fly_short_period;
using sepcal::test::ShortPeriodFlight;
using sepcal::test::stack;

namespace {

const std::map<std::string, double> truth{
    {"Za", -4.0},      {"Ma", -40.0},  {"Mq", -5.0},  {"Zd", -0.35},     {"Md", -45.0},
    {"b_alpha", 0.02}, {"b_q", -0.01}, {"b_az", 0.5}, {"alpha_0", 0.01}, {"q_0", -0.05}};

FitOptions white() {
  FitOptions options;
  options.coloured_errors = false;
  options.threads = 1;
  return options;
}

void check_truth(const Fit& fit) {
  for (const auto& [name, value] : truth) {
    const auto& parameter = fit[name];
    INFO(name << " " << parameter.value << " +- " << parameter.standard_error << " of " << value);
    CHECK(std::abs(parameter.value - value) < 4.0 * parameter.standard_error);
  }
}

/// To 1e-8 standard errors.
void check_same(const sepcal::Parameter& one, const sepcal::Parameter& other) {
  INFO(one.name << " " << one.value << " +- " << one.standard_error << " and " << other.value);
  CHECK(std::abs(one.value - other.value) < 1e-8 * one.standard_error);
  CHECK(one.standard_error == Approx(other.standard_error).epsilon(1e-6));
}

}  // namespace

TEST_CASE("the short period's trajectory is the matrix exponential's") {
  const Record record = fly_short_period({.noise = {0, 0, 0}});
  const TrajectoryModel<ShortPeriod> model(ShortPeriod{}, record);
  VectorXd xi1(7);
  xi1 << 0.02, -0.01, 0.5, -0.35, -45, 0.01, -0.05;
  VectorXd xi2(3);
  xi2 << -4, -40, -5;
  const VectorXd read = sepcal::test::outputs_of(model, record, xi2, xi1);
  const auto N = static_cast<Index>(record.rows());
  for (Index j = 0; j < 3; ++j) {
    const auto column = record.column(model.tables().outputs[static_cast<std::size_t>(j)].name);
    const Eigen::Map<const VectorXd> z(column.data(), N);
    CHECK((read.segment(j * N, N) - z).cwiseAbs().maxCoeff() < 1e-4 * z.cwiseAbs().maxCoeff());
  }
  CHECK(sepcal::test::error_of_tangent(model, record, xi2, xi1) < 1e-7);
}

TEST_CASE("separable output error needs no start, and has the joint answer to 1e-8") {
  const Record record = fly_short_period({.quantum = 0.001});
  const TrajectoryModel<ShortPeriod> separable(ShortPeriod{}, record);
  CHECK(separable.tables().n_2() == 3);
  FitOptions options = white();
  options.samples = 100;
  const Fit one = sepcal::fit(separable, record, options);
  CHECK(one.status == FitStatus::converged);
  CHECK(one.second_stage == sepcal::SecondStage::projected);
  CHECK(one.stage_one.samples.cols() == 100);
  check_truth(one);

  const TrajectoryModel<ShortPeriod> joint(ShortPeriod{}, record, {.separable = false});
  CHECK(joint.tables().n_2() == 7);
  FitOptions started = white();
  started.start = {{"Za", -5}, {"Ma", -30}, {"Mq", -4}, {"Zd", 0}, {"Md", -30}};
  const Fit other = sepcal::fit(joint, record, started);
  CHECK(other.status == FitStatus::converged);
  for (const auto& parameter : one.parameters) check_same(parameter, other[parameter.name]);
}

TEST_CASE("several maneuvers, each with its own initial state, are one stacked fit") {
  std::vector<std::pair<std::string, Record>> flights;
  flights.emplace_back("first", fly_short_period({.start = {0.01, -0.05}, .rows = 500}));
  flights.emplace_back("second",
                       fly_short_period({.start = {-0.02, 0.03}, .rows = 800, .seed = 2}));
  flights.emplace_back("third", fly_short_period({.start = {0.03, 0.1}, .rows = 600, .seed = 3}));
  sepcal::ManyOptions options{.own = {"alpha_0", "q_0"}, .fit = white()};
  options.fit.samples = 60;
  const TrajectoryModel<ShortPeriod> each(ShortPeriod{});
  const sepcal::ManyFit many = sepcal::fit_many(each, flights, options);
  CHECK(many.status == FitStatus::converged);

  const Record stacked = stack(flights);
  const TrajectoryModel<ShortPeriod> all(ShortPeriod{}, stacked);
  const Fit one = sepcal::fit(all, stacked, options.fit);
  const auto check = [](const sepcal::Parameter& found, const sepcal::Parameter& expected) {
    INFO(expected.name);
    CHECK(std::abs(found.value - expected.value) < 1e-8 * expected.standard_error);
  };
  for (const auto& parameter : many.shared) check(parameter, one[parameter.name]);
  for (const auto& flight : many.flights) {
    for (const auto& parameter : flight.own) {
      check(parameter, one[parameter.name + "[" + flight.name + "]"]);
    }
  }
}

TEST_CASE("an unstable aircraft is fitted by multiple shooting") {
  ShortPeriodFlight flight;
  flight.F << -1.5, 1, 12, -1;  // one mode grows by e^2.2 a second
  flight.feedback = {0.6, 0.15};
  const Record record = fly_short_period(flight);
  const TrajectoryModel<ShortPeriod> model(ShortPeriod{}, record, {.shoot = 1.0});
  FitOptions options = white();
  options.samples = 100;
  const Fit fit = sepcal::fit(model, record, options);
  CHECK(fit.status == FitStatus::converged);
  for (const auto& [name, value] : std::map<std::string, double>{
           {"Za", -1.5}, {"Ma", 12}, {"Mq", -1}, {"Zd", -0.35}, {"Md", -45}}) {
    INFO(name << " " << fit[name].value << " +- " << fit[name].standard_error);
    CHECK(std::abs(fit[name].value - value) < 4.0 * fit[name].standard_error);
  }
}

TEST_CASE("without shooting it runs away at every sample, and that is said") {
  ShortPeriodFlight flight;
  flight.F << -1.5, 1, 12, -1;
  flight.feedback = {0.6, 0.15};
  const Record record = fly_short_period(flight);
  const TrajectoryModel<ShortPeriod> model(ShortPeriod{}, record);
  FitOptions options = white();
  options.samples = 20;
  options.bounds = {{"Ma", {10, 20}}, {"Za", {-2, 0}}, {"Mq", {-2, 0}}};
  CHECK_THROWS_WITH_AS(sepcal::fit(model, record, options),
                       doctest::Contains("or cut long segments (shoot): a state runs away"),
                       sepcal::Error);
}

TEST_CASE("a stable model of an unstable aircraft explains nothing, and that is said") {
  ShortPeriodFlight flight;
  flight.F << -1.5, 1, 12, -1;
  flight.feedback = {0.6, 0.15};
  const Record record = fly_short_period(flight);
  const TrajectoryModel<ShortPeriod> model(ShortPeriod{}, record);
  FitOptions options = white();
  options.samples = 30;
  options.bounds = {{"Ma", {-200, -150}}, {"Za", {-1, 0}}, {"Mq", {-20, -10}}};
  const Fit fit = sepcal::fit(model, record, options);
  CHECK(fit.status != FitStatus::converged);
  CHECK_MESSAGE(fit.message.find("no better than its mean would") != std::string::npos,
                fit.message);
}

TEST_CASE("errors of a state grow by the largest eigenvalue") {
  const Record record = fly_short_period({});
  const TrajectoryModel<ShortPeriod> whole(ShortPeriod{}, record, {.separable = false});
  const TrajectoryModel<ShortPeriod> pieces(ShortPeriod{}, record,
                                            {.shoot = 1.0, .separable = false});
  const auto grown = [&](const TrajectoryModel<ShortPeriod>& model, double Ma) {
    std::map<std::string, double> values{{"Za", -1.5}, {"Ma", Ma}, {"Mq", -1.0}};
    Eigen::VectorXd xi =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model.tables().parameters().size()));
    for (Eigen::Index k = 0; k < xi.size(); ++k) {
      const auto at = values.find(model.tables().parameters()[static_cast<std::size_t>(k)].name);
      if (at != values.end()) xi[k] = at->second;
    }
    return model.growth(record, xi);
  };
  const auto exact = [&](double Ma, double seconds) {  // lambda^2 + 2.5 lambda + 1.5 - Ma = 0
    return std::exp(seconds * (-1.25 + std::sqrt(1.25 * 1.25 - 1.5 + Ma)));
  };
  const double span = record.column("time").back() - record.column("time").front();
  CHECK(grown(whole, 12.0) == Approx(exact(12.0, span)).epsilon(1e-3));
  CHECK(grown(pieces, 12.0) == Approx(exact(12.0, 1.0)).epsilon(1e-3));
  CHECK(grown(whole, -12.0) == 1.0);
}

}  // namespace output_error_test
