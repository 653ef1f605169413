// SPDX-License-Identifier: BSD-3-Clause
// A model with parameters of each flight's own, against the model itself at each flight's values.
#include "flight/joint/own_by_flight.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "model/lane_kit.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/fit_many.hpp"
#include "simulated_fleets.hpp"

namespace own_by_flight_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using namespace sepcal;
using joint::OwnByFlight;
using sepcal::test::Draws;
using test::fleet_probe;
using test::Flights;

namespace {

const std::vector<std::string> flight_names{"one", "two", "three"};

/// Blocks of one flight each: its inputs, and its number beside them.
struct FlightBlock {
  std::vector<const double*> inputs;
  std::vector<double> number;
  Block block;

  FlightBlock(const BlockModel& model, const Record& record, std::size_t rows, double flight)
      : number(rows, flight) {
    for (const Variable& input : model.tables().inputs) {
      if (input.name == joint::flight_number) {
        inputs.push_back(number.data());
      } else if (record.has(input.name)) {
        inputs.push_back(record.column(input.name).data());
      } else {
        inputs.push_back(zeros().data());
      }
    }
    block = {inputs, rows, 0, true};
  }

 private:
  static const std::vector<double>& zeros() {
    static const std::vector<double> all(1000, 0.0);
    return all;
  }
};

}  // namespace

TEST_CASE("on a flight the model is the model at that flight's parameters") {
  const StaticModel<FiveHoleProbe> probe(fleet_probe);
  const OwnByFlight model(probe, {"w_n", "b_alpha", "w_e"}, flight_names);
  CHECK(model.tables().n_1() == 5 + 2 * 3);
  CHECK(model.tables().n_2() == 5 + 3);
  CHECK(model.tables().linear[5].name == "w_n@one");
  CHECK(model.tables().nonlinear[7].name == "b_alpha@three");
  const Record record = test::simulate_fleet({}).front().second;
  Draws draws(5);
  const VectorXd xi1 = draws.normal_matrix(11, 1);
  const VectorXd xi2 = 0.1 * draws.normal_matrix(8, 1);
  constexpr std::size_t rows = 40;
  for (Index k = 0; k < 3; ++k) {
    CAPTURE(k);
    const FlightBlock of_all(model, record, rows, static_cast<double>(k));
    const FlightBlock of_one(probe, record, rows, 0.0);
    VectorXd own_1 = xi1.head(5);
    own_1[2] += xi1[5 + 2 * k];
    own_1[3] += xi1[6 + 2 * k];
    VectorXd own_2 = xi2.head(5);
    own_2[1] += xi2[5 + k];
    MatrixXd expected(3 * rows, 5 + 5 + 1);
    probe.evaluate(of_one.block, own_2.data(), own_1.data(), nullptr, expected);
    MatrixXd found(3 * rows, 11 + 8 + 1);
    model.evaluate(of_all.block, xi2.data(), xi1.data(), nullptr, found);
    CHECK(found.leftCols(5) == expected.leftCols(5));
    CHECK(found.middleCols(11, 5) == expected.middleCols(5, 5));
    CHECK(found.rightCols<1>() == expected.rightCols<1>());
    for (Index other = 0; other < 3; ++other) {
      const MatrixXd winds = found.middleCols(5 + 2 * other, 2);
      const VectorXd bias = found.col(11 + 5 + other);
      if (other == k) {
        CHECK(winds == expected.middleCols(2, 2));
        CHECK(bias == expected.col(6));
      } else {
        CHECK(winds.isZero(0.0));
        CHECK(bias.isZero(0.0));
      }
    }
  }
}

TEST_CASE("no output moves with a flight's number, and with other inputs as the model's do") {
  const StaticModel<FiveHoleProbe> probe(fleet_probe);
  const OwnByFlight joint(probe, {"w_n", "b_alpha"}, flight_names);
  const Record record = test::simulate_fleet({}).front().second;
  const FlightBlock alone(probe, record, 40, 0.0);
  const FlightBlock on_first(joint, record, 40, 0.0);
  Draws draws(9);
  const VectorXd xi1 = draws.normal_matrix(joint.tables().n_1(), 1);
  const VectorXd xi2 = 0.02 * VectorXd(draws.normal_matrix(joint.tables().n_2(), 1));
  const int number = probe.tables().n_u();
  const std::vector<int> inputs{number, 0, 7, number, 11};
  MatrixXd found(120, 5);
  joint.input_tangent(on_first.block, xi2.data(), xi1.data(), inputs, found);
  CHECK(found.col(0).isZero(0.0));
  CHECK(found.col(3).isZero(0.0));
  VectorXd own_1 = xi1.head(probe.tables().n_1());
  VectorXd own_2 = xi2.head(probe.tables().n_2());
  own_1[2] += xi1[probe.tables().n_1()];  // w_n
  own_2[1] += xi2[probe.tables().n_2()];  // b_alpha
  MatrixXd expected(120, 3);
  probe.input_tangent(alone.block, own_2.data(), own_1.data(), std::vector<int>{0, 7, 11},
                      expected);
  CHECK((found(Eigen::all, std::vector<int>{1, 2, 4}) - expected).norm() < 1e-12 * expected.norm());
}

TEST_CASE("a fit with winds of their own is fit_many's, lanes and all") {
  const Flights flights = test::simulate_fleet({});
  const StaticModel<FiveHoleProbe> probe(fleet_probe);
  const OwnByFlight model(probe, {"w_n", "w_e", "w_d"}, flight_names);
  CHECK(model.lane_width() == probe.lane_width());
  FitOptions options;
  options.fix = {{"w_n", 0.0}, {"w_e", 0.0}, {"w_d", 0.0}};
  const Fit stacked = fit(model, test::stack(flights, joint::flight_number), options);
  const ManyFit many = fit_many(fleet_probe, flights, test::wind_a_flight());
  REQUIRE(stacked.status == FitStatus::converged);
  REQUIRE(many.status == FitStatus::converged);
  const auto check_same = [&](const Parameter& found, const Parameter& expected) {
    CAPTURE(found.name);
    CHECK(std::abs(found.value - expected.value) < 1e-9 * expected.standard_error_white);
    CHECK(found.standard_error_white == Approx(expected.standard_error_white).epsilon(1e-7));
  };
  for (const Parameter& shared : many.shared) check_same(stacked[shared.name], shared);
  for (std::size_t k = 0; k < flights.size(); ++k) {
    for (const Parameter& own : many.flights[k].own) {
      check_same(stacked[joint::name_of_own(own.name, flight_names[k])], own);
    }
  }
  // A sample asked for in lanes is one asked for by itself.
  options.samples = 40;
  options.descents = 1;
  const Fit in_lanes = fit(model, test::stack(flights, joint::flight_number), options);
  CHECK(in_lanes.cost == Approx(stacked.cost).epsilon(1e-12));
}

}  // namespace own_by_flight_test
