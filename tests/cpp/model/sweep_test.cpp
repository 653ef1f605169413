// SPDX-License-Identifier: BSD-3-Clause
// Passes over a record against the whole record in dense matrices, on one thread and on several.
#include "model/sweep.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "dense_reference.hpp"
#include "sepcal/static_model.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace sweep_test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::base::ThreadPool;
using sepcal::model::Measurements;
using sepcal::model::Sweep;
using sepcal::test::Simulated;

namespace {

/// Five-hole flights of three segments, cut where neither blocks nor chunks end.
Simulated flight_in_segments(std::size_t rows) {
  Simulated flight = sepcal::test::simulate_five_hole(rows);
  flight.record.cut({{"a", 1, rows / 3}, {"b", rows / 3, rows / 2}, {"c", rows / 2 + 5, rows}});
  return flight;
}

double relative_error(const MatrixXd& a, const MatrixXd& b) { return (a - b).norm() / b.norm(); }

}  // namespace

TEST_CASE("the factors by output are those of the dense rows") {
  const Simulated flight = flight_in_segments(10'000);
  const Measurements measurements(*flight.model, flight.record);
  ThreadPool pool(2);
  const Sweep sweep(*flight.model, measurements, pool);
  const auto N = static_cast<Index>(measurements.rows());

  const MatrixXd dense =
      sepcal::test::dense_rows(*flight.model, flight.record, flight.xi1, flight.xi2);
  const auto tangent = sweep.tangent_factors(flight.xi1, flight.xi2);
  const auto linear = sweep.linear_factors(flight.xi2);
  REQUIRE(tangent.size() == 3);
  for (Index j = 0; j < 3; ++j) {
    const MatrixXd rows = dense.middleRows(j * N, N);
    const MatrixXd& T = tangent[static_cast<std::size_t>(j)].matrix();
    CHECK(relative_error(T.transpose() * T, rows.transpose() * rows) < 1e-9);

    MatrixXd z_minus_b(N, 6);
    z_minus_b << rows.leftCols<5>(), rows.col(10) + rows.leftCols<5>() * flight.xi1;
    const MatrixXd& L = linear[static_cast<std::size_t>(j)].matrix();
    CHECK(relative_error(L.transpose() * L, z_minus_b.transpose() * z_minus_b) < 1e-12);
  }
}

TEST_CASE("residuals come in the record's order, their squares by output") {
  const Simulated flight = flight_in_segments(9'000);
  const Measurements measurements(*flight.model, flight.record);
  ThreadPool pool(3);
  const Sweep sweep(*flight.model, measurements, pool);
  const MatrixXd r = sweep.residuals(flight.xi1, flight.xi2);
  const VectorXd expected =
      sepcal::test::dense_outputs(*flight.model, flight.record) -
      sepcal::test::dense_prediction(*flight.model, flight.record, flight.xi1, flight.xi2);
  CHECK((r.reshaped() - expected).norm() < 1e-12 * expected.norm());
  const VectorXd squares = sweep.squared_residuals(flight.xi1, flight.xi2);
  for (Index j = 0; j < 3; ++j) CHECK(squares[j] == doctest::Approx(r.col(j).squaredNorm()));
}

TEST_CASE("any number of threads gives the same factors, bit for bit") {
  const Simulated flight = flight_in_segments(20'000);
  const Measurements measurements(*flight.model, flight.record);
  const auto run = [&](int threads) {
    ThreadPool pool(threads);
    return Sweep(*flight.model, measurements, pool).tangent_factors(flight.xi1, flight.xi2);
  };
  const auto one = run(1);
  for (const int threads : {2, 3, 7}) {
    const auto several = run(threads);
    for (std::size_t j = 0; j < 3; ++j) CHECK(several[j].matrix() == one[j].matrix());
  }
}

TEST_CASE("the squares of many samples are those of each, progress rising to one") {
  const Simulated flight = flight_in_segments(6'000);
  const Measurements measurements(*flight.model, flight.record);
  ThreadPool pool(2);
  const Sweep sweep(*flight.model, measurements, pool);
  sepcal::test::Draws draws(61);
  const MatrixXd samples = 0.1 * draws.normal_matrix(5, 60);
  double last = 0;
  const VectorXd squares = sweep.sample_squares(samples, [&](double fraction) {
    CHECK(fraction > last);
    last = fraction;
  });
  CHECK(last == 1.0);
  REQUIRE(squares.size() == 60);
  for (const Index s : {0, 24, 25, 59}) {
    const VectorXd xi2 = samples.col(s);
    const double expected =
        remaining_square(sepcal::combine(sweep.linear_factors(xi2), VectorXd::Ones(3)));
    CHECK(squares[s] == doctest::Approx(expected).epsilon(1e-12));
  }
}

TEST_CASE("a model with nothing linear has a tangent all the same") {
  sepcal::Record record;
  record.add("u", {0.5, -2.0}).add("z", {1.0, 2.0});
  const auto model = sepcal::block_model(sepcal::test::Growth{});
  const Measurements measurements(*model, record);
  ThreadPool pool(1);
  const MatrixXd T = Sweep(*model, measurements, pool)
                         .tangent_factors(VectorXd(0), VectorXd::Constant(1, 0.3))[0]
                         .matrix();
  MatrixXd rows(2, 2);
  rows << 0.5 * std::exp(0.15), 1.0 - std::exp(0.15), -2 * std::exp(-0.6), 2.0 - std::exp(-0.6);
  CHECK((T.transpose() * T - rows.transpose() * rows).norm() < 1e-14);
}

}  // namespace sweep_test
