// SPDX-License-Identifier: BSD-3-Clause
// Predictions against the textbook's regression line, against dense rows, and what is refused.
#include "sepcal/prediction.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "dense_reference.hpp"
#include "sepcal/error.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

namespace prediction_test {

using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::Prediction;
using sepcal::Record;
using sepcal::test::Growth;
using sepcal::test::Line;

namespace {

const std::vector<double> times{0.1, 0.4, 1.3, 1.9, 2.2, 3.1};
const std::vector<double> readings{0.3, 0.2, 1.1, 1.2, 1.9, 2.0};

FitOptions white() {
  FitOptions options;
  options.samples = 50;
  options.coloured_errors = false;
  return options;
}

Record record_of(const std::vector<double>& u, const std::vector<double>& z) {
  Record record;
  record.add("u", u).add("z", z);
  return record;
}

}  // namespace

TEST_CASE("a regression line's bands are the textbook's") {
  const Fit fit = sepcal::fit(Line{}, record_of(times, readings), white());
  Record elsewhere;
  elsewhere.add("u", {-2.0, 1.5, 8.0});
  const Prediction prediction = sepcal::predict(Line{}, elsewhere, fit, white());
  CHECK(prediction.quantile == Approx(2.7764451051977934).epsilon(1e-12));  // SciPy, 4 degrees

  const auto n = static_cast<double>(times.size());
  const double mean = std::accumulate(times.begin(), times.end(), 0.0) / n;
  double uu = 0.0;
  double square = 0.0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    uu += (times[i] - mean) * (times[i] - mean);
    square += std::pow(readings[i] - fit["c"].value - fit["s"].value * times[i], 2);
  }
  for (Index i = 0; i < 3; ++i) {
    const double u = elsewhere.column("u")[static_cast<std::size_t>(i)];
    const double variance = square / (n - 2) * (1 / n + (u - mean) * (u - mean) / uu);
    CHECK(prediction.value(i, 0) == Approx(fit["c"].value + fit["s"].value * u).epsilon(1e-12));
    CHECK(prediction.standard_error(i, 0) == Approx(std::sqrt(variance)).epsilon(1e-9));
    CHECK(prediction.measurement_error(i, 0) ==
          Approx(std::sqrt(variance + square / (n - 2))).epsilon(1e-9));
  }
}

TEST_CASE("of a given noise the quantile is the normal's") {
  FitOptions options = white();
  options.noise = {{"z", 0.3}};
  const Record record = record_of(times, readings);
  const Fit fit = sepcal::fit(Line{}, record, options);
  CHECK(sepcal::predict(Line{}, record, fit, options).quantile ==
        Approx(1.959963984540054).epsilon(1e-12));
}

TEST_CASE("nothing linear: the error is that of the tangent") {
  const Record record = record_of(times, {1.1, 1.3, 1.9, 2.4, 3.2, 4.5});
  const Fit fit = sepcal::fit(Growth{}, record, white());
  const Prediction prediction = sepcal::predict(Growth{}, record, fit, white());
  for (Index i = 0; i < 6; ++i) {
    const double u = times[static_cast<std::size_t>(i)];
    const double value = std::exp(fit["c"].value * u);
    CHECK(prediction.value(i, 0) == Approx(value).epsilon(1e-12));
    CHECK(prediction.standard_error(i, 0) ==
          Approx(u * value * fit["c"].standard_error).epsilon(1e-9));
  }
}

TEST_CASE("what is held or at a bound takes no part; what is undefined is not hidden") {
  FitOptions options = white();
  options.bounds = {{"c", {5, 6}}};
  const Record record = record_of(times, readings);
  const Fit fit = sepcal::fit(Line{}, record, options);
  REQUIRE(fit["c"].at_bound);
  const Prediction prediction = sepcal::predict(Line{}, record, fit, options);
  CHECK(prediction.standard_error(3, 0) ==
        Approx(times[3] * fit["s"].standard_error).epsilon(1e-9));

  const Record flat = record_of(std::vector<double>(6, 0.0), readings);
  const Fit open = sepcal::fit(Line{}, flat, white());
  CHECK(std::isnan(sepcal::predict(Line{}, flat, open).standard_error(0, 0)));
}

TEST_CASE("several outputs, cut into segments, on any number of threads") {
  auto flight = sepcal::test::simulate_five_hole(9000);
  flight.record.cut({{"first", 0, 300}, {"second", 500, 9000}});
  FitOptions options = white();
  const Fit fit = sepcal::fit(*flight.model, flight.record, options);
  options.threads = 1;
  const Prediction prediction = sepcal::predict(*flight.model, flight.record, fit, options);
  options.threads = 3;
  CHECK(sepcal::predict(*flight.model, flight.record, fit, options).standard_error ==
        prediction.standard_error);

  const MatrixXd rows =
      sepcal::test::dense_rows(*flight.model, flight.record, fit.xi1(), fit.xi2());
  const Index n = rows.cols() - 1;
  const Index N = prediction.value.rows();
  REQUIRE(rows.rows() == 3 * N);
  const auto vn = flight.record.column("vn");
  CHECK(prediction.value(0, 0) == Approx(vn[0] - rows(0, n)).epsilon(1e-12));
  CHECK(prediction.value(300, 0) == Approx(vn[500] - rows(300, n)).epsilon(1e-12));
  const Eigen::VectorXd g = rows.row(300).head(n);
  CHECK(prediction.standard_error(300, 0) ==
        Approx(std::sqrt(g.dot(fit.covariance * g))).epsilon(1e-9));
}

TEST_CASE("an input that is missing, another model and a level beyond 1 are refused") {
  const Record record = record_of(times, readings);
  const Fit fit = sepcal::fit(Line{}, record, white());
  Record empty;
  empty.add("x", {1, 2});
  CHECK_THROWS_WITH_AS((void)sepcal::predict(Line{}, empty, fit), doctest::Contains("'u'"),
                       sepcal::Error);
  CHECK_THROWS_WITH_AS((void)sepcal::predict(Growth{}, record, fit),
                       doctest::Contains("not the model's"), sepcal::Error);
  CHECK_THROWS_AS((void)sepcal::predict(Line{}, record, fit, {}, 1.0), sepcal::Error);
}

}  // namespace prediction_test
