// SPDX-License-Identifier: BSD-3-Clause
// Flight path reconstruction on a motion that is written down in closed form.
#include "sepcal/models/flight_path.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/states/reconstruct.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "flight_paths.hpp"
#include "sepcal/check_model.hpp"
#include "sepcal/error.hpp"
#include "sepcal/fit.hpp"
#include "trajectories.hpp"

namespace flight_path_test {

using doctest::Contains;
using Eigen::Index;
using Eigen::VectorXd;
using sepcal::Error;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::FlightPath;
using sepcal::FlightPathWithPosition;
using sepcal::Record;
using sepcal::TrajectoryModel;
using sepcal::test::write_flight;
using sepcal::test::WrittenFlight;

namespace {

const std::map<std::string, double> errors{
    {"b_ax", 0.15},   {"b_ay", -0.1},        {"b_az", 0.2},           {"b_p", 2e-3},
    {"b_q", -3e-3},   {"b_r", 1.5e-3},       {"lambda_v", 0.03},      {"b_v", 0.5},
    {"b_beta", 3e-3}, {"lambda_beta", 0.05}, {"lambda_alpha", -0.08}, {"b_alpha", 0.01}};

const std::vector<std::string> angles_and_speed{"airspeed", "beta",  "alpha",
                                                "roll",     "pitch", "yaw"};

FitOptions started(const TrajectoryModel<FlightPath>& model, const Record& record) {
  FitOptions options;
  options.start = model.initial_states(record);
  options.coloured_errors = false;
  return options;
}

/// The motion's own values at t = 0.
double true_start(const WrittenFlight& flight, const std::string& name) {
  const std::vector<std::string> names{"u_0", "v_0", "w_0", "phi_0", "theta_0", "psi_0"};
  const auto i = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  return i < 3 ? flight.velocity[i].value(0) : flight.attitude[i - 3].value(0);
}

}  // namespace

TEST_CASE("a motion that is written down is found again from its accelerations and rates") {
  const WrittenFlight flight;
  const Record record = write_flight(flight, 2001, 0.01, {}, 0.0);
  const TrajectoryModel<FlightPath> model(FlightPath{}, record);
  VectorXd xi2 = VectorXd::Zero(12);
  for (int i = 0; i < 6; ++i) {
    const auto state = static_cast<std::size_t>(i);
    xi2[6 + i] = i < 3 ? flight.velocity[state].value(0) : flight.attitude[state - 3].value(0);
  }
  VectorXd xi1 = VectorXd::Zero(15);
  xi1.tail(3) = flight.wind;
  const VectorXd read = sepcal::test::outputs_of(model, record, xi2, xi1);
  for (std::size_t j = 0; j < 9; ++j) {
    const auto column = record.column(FlightPath::outputs[j].name);
    const Eigen::Map<const VectorXd> z(column.data(), 2001);
    // Straight lines between rows 0.01 s apart: dt^2 / 12 times the input's curvature.
    CHECK((read.segment(static_cast<Index>(j) * 2001, 2001) - z).cwiseAbs().maxCoeff() < 2e-3);
  }
}

TEST_CASE("what was flown is reconstructed from the parameters") {
  const WrittenFlight flight;
  const Record record = write_flight(flight, 1001, 0.01, errors, 0.0);
  const TrajectoryModel<FlightPath> model(FlightPath{}, record, {.outputs = angles_and_speed});
  std::map<std::string, double> parameters;
  for (const auto& parameter : model.tables().parameters()) {
    const auto at = errors.find(parameter.name);
    const bool start = parameter.name.ends_with("_0");
    parameters[parameter.name] = start                ? true_start(flight, parameter.name)
                                 : at == errors.end() ? 0.0
                                                      : at->second;
  }
  const Record found = sepcal::reconstruct(model, parameters, record);
  const Record exact = write_flight(flight, 1001, 0.01, {}, 0.0);
  for (const char* name : {"ax", "az", "q", "airspeed", "alpha", "beta", "roll", "yaw"}) {
    INFO(name);
    for (const std::size_t row : {0U, 500U, 1000U}) {
      CHECK(std::abs(found.column(name)[row] - exact.column(name)[row]) < 2e-3);
    }
  }
  CHECK(std::abs(found.column("w")[900] - flight.velocity[2].value(9.0)) < 2e-3);
  CHECK(found.column("roll")[700] == found.column("phi")[700]);
  Record cut = write_flight(flight, 1001, 0.01, errors, 0.0);
  cut.cut({{"", 0, 200}});
  CHECK(std::isnan(sepcal::reconstruct(model, parameters, cut).column("u")[300]));
}

TEST_CASE("its derivatives are those of differences, with and without position") {
  const Record record = write_flight({}, 60, 0.05, errors, 1.0);
  const TrajectoryModel<FlightPath> model(FlightPath{.vane = {2.0, 0.3, -0.5}}, record);
  VectorXd xi2(12);
  xi2 << 0.1, -0.2, 0.3, 0.01, -0.02, 0.03, 50, 1, 3, 0.1, 0.2, 0.4;
  VectorXd xi1 = VectorXd::LinSpaced(15, -0.1, 0.1);
  CHECK(sepcal::test::error_of_tangent(model, record, xi2, xi1) < 1e-7);
  const TrajectoryModel<FlightPathWithPosition> with(FlightPathWithPosition{}, record);
  VectorXd longer(18);
  longer << xi2.head(6), 3, -2, 0.5, xi2.tail(6), 10, 20, -30;
  CHECK(sepcal::test::error_of_tangent(with, record, longer, xi1.head(12)) < 1e-7);
}

TEST_CASE("biases, scales and initial states come back within four standard errors") {
  const WrittenFlight flight;
  const Record record = write_flight(flight, 1500, 0.02, errors, 1.0);
  const TrajectoryModel<FlightPath> model(FlightPath{}, record, {.outputs = angles_and_speed});
  FitOptions options = started(model, record);
  options.fix = {{"b_psi", 0.0}};
  const Fit fit = sepcal::fit(model, record, options);
  CHECK(fit.status == sepcal::FitStatus::converged);
  for (const auto& parameter : fit.parameters) {
    if (parameter.fixed) continue;
    const auto at = errors.find(parameter.name);
    const double truth = parameter.name.ends_with("_0") ? true_start(flight, parameter.name)
                         : at == errors.end()           ? 0.0
                                                        : at->second;
    INFO(parameter.name << " " << parameter.value << " +- " << parameter.standard_error << " of "
                        << truth);
    CHECK(std::abs(parameter.value - truth) < 4.0 * parameter.standard_error);
  }
}

TEST_CASE("the wind comes from the velocity over the ground") {
  const WrittenFlight flight;
  const Record record = write_flight(flight, 1500, 0.02, {}, 1.0);
  const TrajectoryModel<FlightPath> model(
      FlightPath{}, record,
      {.outputs = {"airspeed", "alpha", "beta", "roll", "pitch", "yaw", "vn", "ve", "vd"}});
  FitOptions options = started(model, record);
  for (const char* name : {"b_v", "b_alpha", "b_psi"}) options.fix[name] = 0.0;
  const Fit fit = sepcal::fit(model, record, options);
  for (int i = 0; i < 3; ++i) {
    const auto& wind = fit[std::array{"w_n", "w_e", "w_d"}[static_cast<std::size_t>(i)]];
    CHECK(std::abs(wind.value - flight.wind[i]) < 4.0 * wind.standard_error);
  }
}

TEST_CASE("with all 24 parameters exactly one combination is unseen: psi_0 with b_psi") {
  const Record record = write_flight({}, 1500, 0.02, errors, 1.0);
  const TrajectoryModel<FlightPath> model(FlightPath{}, record, {.outputs = angles_and_speed});
  REQUIRE(model.tables().parameters().size() == 24);
  const Fit fit = sepcal::fit(model, record, started(model, record));
  CHECK(fit.status == sepcal::FitStatus::not_identifiable);
  REQUIRE(fit.identifiability.unobservable.size() == 1);
  std::vector<std::string> names = fit.identifiability.unobservable.front().parameters;
  std::ranges::sort(names);
  CHECK(names == std::vector<std::string>{"b_psi", "psi_0"});
  CHECK(fit.identifiability.rank == 23);
  const bool either = fit.message.find("b_psi and psi_0 can't be told apart") < std::string::npos ||
                      fit.message.find("psi_0 and b_psi can't be told apart") < std::string::npos;
  CHECK_MESSAGE(either, fit.message);  // they weigh the same
}

TEST_CASE("a record that is no flight path's is refused in one line") {
  const Record sound = write_flight({}, 50, 0.02, {}, 0.0);
  const auto with = [&](const std::string& name, double factor, double offset) {
    Record changed;
    for (const std::string& column : sound.names()) {
      std::vector<double> values(sound.column(column).begin(), sound.column(column).end());
      if (column == name) {
        for (double& value : values) value = factor * value + offset;
      }
      changed.add(column, std::move(values));
    }
    return TrajectoryModel<FlightPath>(FlightPath{}, changed);
  };
  CHECK_NOTHROW(with("pitch", 1.0, 0.0));
  CHECK_THROWS_WITH_AS(with("pitch", 1.0, 1.5), Contains("a flight path is reconstructed up to 85"),
                       Error);
  CHECK_THROWS_WITH_AS(with("az", -1.0, 0.0), Contains("level flight must read az = -9.81"), Error);
  for (const double factor : {1.0 / 9.81, -1.0 / 9.81}) {
    CHECK_THROWS_WITH_AS(with("az", factor, 0.0), Contains("is it in g, or gravity taken out?"),
                         Error);
  }
  CHECK_THROWS_WITH_AS(with("airspeed", -1.0, 0.0), Contains("airspeed is negative"), Error);
  CHECK_THROWS_WITH_AS(with("pitch", 57.3, 0.0), Contains("it is probably in degrees"), Error);
  CHECK_THROWS_WITH_AS(with("roll", 57.3, 0.0), Contains("it is probably in degrees"), Error);
  CHECK_THROWS_WITH_AS(with("q", 57.3, 0.0), Contains("'q' reaches"), Error);
  Record without = sound;
  without.cut({{"", 0, 50}});
  Record missing;
  for (const std::string& column : sound.names()) {
    if (column != "r") missing.view(column, sound.column(column));
  }
  const TrajectoryModel<FlightPath> model(FlightPath{}, missing);
  CHECK_THROWS_WITH_AS(check_model(model, missing, model.initial_states(missing)),
                       Contains("column 'r' is missing"), Error);
}

TEST_CASE("a path that pitches beyond 85 deg while it is tried is no number, and no exception") {
  const Record record = write_flight({}, 200, 0.02, {}, 0.0);
  const TrajectoryModel<FlightPath> model(FlightPath{}, record);
  VectorXd xi2 = VectorXd::Zero(12);
  xi2 << 0, 0, 0, 0, 0.5, 0, 50, 0, 3, 0, 1.3, 0;
  const auto rows = sepcal::test::rows_of(model, record, xi2, nullptr);
  CHECK(std::isfinite(rows(0, 15)));
  CHECK(std::isnan(rows(199, 15)));
}

}  // namespace flight_path_test
