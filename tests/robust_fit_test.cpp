// SPDX-License-Identifier: BSD-3-Clause
// Fits that forgive outliers, as statistics over 1,000 flights of fixed seeds. A count is held
// against the central 99.9 % of a binomial, whose rate other flights gave (beside each): with other
// seeds a correct build fails a count once in 1,000 at a nominal rate, and, since a rate of 4,000
// flights is itself uncertain, about once in 300 at a measured one.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "dense_reference.hpp"
#include "noises.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/models/scalar_examples.hpp"
#include "simulated_records.hpp"

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Loss;
using sepcal::Record;

namespace {

constexpr int flights = 1000;
constexpr std::array truth{0.3, 0.5, 0.2};  // a, c, b

/// Scalar example 1, 200 rows, noise of 0.1; every twentieth reading is off by 30 of these, up or,
/// where `both_ways`, up or down.
Record simulate_with_outliers(std::uint64_t seed, bool both_ways) {
  sepcal::test::Draws draws(seed);
  std::vector<double> eta = draws.uniform_column(200, 0.0, 2.0 * std::numbers::pi);
  std::vector<double> z;
  for (std::size_t k = 0; k < eta.size(); ++k) {
    double reading = (1.0 + truth[0]) * std::cos(eta[k] + truth[2]) + truth[1];
    reading += 0.1 * draws.normal();
    const double sign = both_ways && draws.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
    if (k % 20 == 7) reading += 3.0 * sign;
    z.push_back(reading);
  }
  Record record;
  record.add("eta", std::move(eta)).add("z", std::move(z));
  return record;
}

/// Flights that miss the truth, each by its own standard errors.
struct Misses {
  std::array<int, 3> of_95{};  // of a, c, b: by more than 1.96
  int of_three = 0;            // any of the three by more than 3
};

Misses count(Loss loss, bool both_ways) {
  FitOptions options;
  options.loss = loss;
  options.samples = 10;
  options.threads = 1;
  Misses misses;
  for (int seed = 0; seed < flights; ++seed) {
    const Record record = simulate_with_outliers(static_cast<std::uint64_t>(seed), both_ways);
    const Fit fit = sepcal::fit(sepcal::ScalarExample1{}, record, options);
    REQUIRE(fit.status == sepcal::FitStatus::converged);
    bool far = false;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const sepcal::Parameter& parameter = fit.parameters[k];
      const double error = std::abs(parameter.value - truth[k]) / parameter.standard_error;
      misses.of_95[k] += error > 1.96 ? 1 : 0;
      far = far || error > 3.0;
    }
    misses.of_three += far ? 1 : 0;
  }
  MESSAGE(sepcal::to_string(loss) << ", outliers "
                                  << std::string(both_ways ? "both ways" : "one way") << ": of "
                                  << flights << " flights " << misses.of_95[0] << ", "
                                  << misses.of_95[1] << ", " << misses.of_95[2]
                                  << " miss a, c, b at 95 %, " << misses.of_three
                                  << " any by three standard errors");
  return misses;
}

void check_rate(int k, double rate) {
  CAPTURE(k);
  CAPTURE(rate);
  CHECK_FALSE(sepcal::test::outside_binomial(k, flights, rate));
}

/// The farthest estimate of `other`, in standard errors of `fit`.
double distance(const Fit& fit, const Fit& other) {
  double largest = 0.0;
  for (const sepcal::Parameter& parameter : fit.parameters) {
    const double off = std::abs(parameter.value - other[parameter.name].value);
    largest = std::max(largest, off / parameter.standard_error);
  }
  return largest;
}

/// J over the rows, 1 / noise times [A | D] by differences, and r likewise.
struct Dense {
  MatrixXd J;
  VectorXd r;
};
Dense whitened(const sepcal::test::Simulated& flight, const Fit& fit, const VectorXd& noise) {
  const MatrixXd rows = sepcal::test::whiten(
      sepcal::test::dense_rows(*flight.model, flight.record, fit.xi1(), fit.xi2()), noise);
  return {rows.leftCols(rows.cols() - 1), rows.rightCols<1>()};
}

/// Errors by the sandwich H^-1 (sum psi^2 J'J) H^-1 M / (M - n), H = sum psi' J'J, for a loss so
/// wide that psi is the residual: each white row by its own square.
VectorXd own_square_errors(const Dense& dense) {
  const MatrixXd inverse = (dense.J.transpose() * dense.J).inverse();
  const MatrixXd middle = dense.J.transpose() * dense.r.cwiseAbs2().asDiagonal() * dense.J;
  const auto count = static_cast<double>(dense.J.rows());
  const double ratio = count / (count - static_cast<double>(dense.J.cols()));
  return (ratio * (inverse * middle * inverse).diagonal()).cwiseSqrt();
}

}  // namespace

TEST_CASE("outliers on both sides: 95 % intervals of robust fits cover") {
  for (const Loss loss : {Loss::huber, Loss::cauchy}) {
    CAPTURE(sepcal::to_string(loss));
    for (const int misses : count(loss, true).of_95) check_rate(misses, 0.05);
  }
}

TEST_CASE("outliers on one side: each fit by its own standard errors") {
  // Of 4,000 flights with other seeds Huber's c, which a constant force pulls, missed in 776, and
  // any parameter by three errors in 121; Cauchy's in 229 and 39.
  const Misses huber = count(Loss::huber, false);
  check_rate(huber.of_95[1], 776.0 / 4000.0);
  check_rate(huber.of_three, 121.0 / 4000.0);
  const Misses cauchy = count(Loss::cauchy, false);
  check_rate(cauchy.of_95[1], 229.0 / 4000.0);
  check_rate(cauchy.of_three, 39.0 / 4000.0);
  // By its own errors, too, which the outliers raise: of 4,000, 620 stayed within three.
  const Misses plain = count(Loss::squares, false);
  CHECK(plain.of_95[1] >= 990);
  check_rate(flights - plain.of_three, 620.0 / 4000.0);
}

TEST_CASE("outliers raise the noise of the plain fit, and its errors, but not the robust one's") {
  const Record record = simulate_with_outliers(0, false);
  const Fit robust = sepcal::fit(sepcal::ScalarExample1{}, record, {.loss = Loss::cauchy});
  const Fit plain = sepcal::fit(sepcal::ScalarExample1{}, record, {});
  CHECK(robust.method == sepcal::SecondStage::joint);
  CHECK(robust.noise[0].value < 0.13);
  CHECK(plain.noise[0].value > 0.5);
  CHECK(robust["c"].standard_error < 0.3 * plain["c"].standard_error);
}

TEST_CASE("a Huber loss wider than every residual is squares, its errors each row's own") {
  const auto flight = sepcal::test::simulate_five_hole(300);
  FitOptions options;
  options.samples = 50;
  options.second_stage = sepcal::SecondStage::joint;
  options.coloured_errors = false;
  const Fit plain = sepcal::fit(*flight.model, flight.record, options);
  options.loss = Loss::huber;
  options.loss_width = 30.0;  // with it R-hat's truncation at k sigma keeps every row, too
  const Fit wide = sepcal::fit(*flight.model, flight.record, options);
  CHECK(distance(plain, wide) < 1e-9);
  const VectorXd noise =
      Eigen::Vector3d(wide.noise[0].value, wide.noise[1].value, wide.noise[2].value);
  for (std::size_t j = 0; j < 3; ++j) {
    CHECK(wide.noise[j].value == doctest::Approx(plain.noise[j].value).epsilon(1e-10));
  }
  const VectorXd expected = own_square_errors(whitened(flight, wide, noise));
  for (std::size_t k = 0; k < wide.parameters.size(); ++k) {
    CAPTURE(wide.parameters[k].name);
    CHECK(wide.parameters[k].standard_error ==
          doctest::Approx(expected[static_cast<Index>(k)]).epsilon(1e-7));
  }
}

TEST_CASE("a Cauchy loss of width w differs from squares by 1 / w^2 where the noise is given") {
  // Without it R-hat is Huber's scale at 1.345 whatever the width: outputs weigh otherwise.
  const auto flight = sepcal::test::simulate_five_hole(300);
  const VectorXd noise = Eigen::Vector3d(0.1, 0.2, 0.3);
  FitOptions options;
  options.samples = 50;
  options.second_stage = sepcal::SecondStage::joint;
  options.coloured_errors = false;
  for (std::size_t j = 0; j < 3; ++j) {
    options.noise[flight.model->tables().outputs[j].name] = noise[static_cast<Index>(j)];
  }
  const Fit plain = sepcal::fit(*flight.model, flight.record, options);
  options.loss = Loss::cauchy;
  options.loss_width = 10.0;
  const double at_10 = distance(plain, sepcal::fit(*flight.model, flight.record, options));
  options.loss_width = 100.0;
  const double at_100 = distance(plain, sepcal::fit(*flight.model, flight.record, options));
  CHECK(at_10 / at_100 == doctest::Approx(100.0).epsilon(0.1));
  options.loss_width = 1e4;
  const Fit wide = sepcal::fit(*flight.model, flight.record, options);
  // Of first order the distance at w is 1e-6 times that at 10; the last digits are 1e-10.
  CHECK(distance(plain, wide) < 1.2e-6 * at_10 + 1e-9);
  const VectorXd expected = own_square_errors(whitened(flight, wide, noise));
  for (std::size_t k = 0; k < wide.parameters.size(); ++k) {
    CAPTURE(wide.parameters[k].name);
    CHECK(wide.parameters[k].standard_error ==
          doctest::Approx(expected[static_cast<Index>(k)]).epsilon(1e-6));
  }
}
