// SPDX-License-Identifier: BSD-3-Clause
// Profile-likelihood intervals against closed forms where the model is linear, and against the
// sandwich where a loss forgives; what is refused.
#include "sepcal/profile.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <numeric>

#include "profile_records.hpp"
#include "sepcal/error.hpp"
#include "small_models.hpp"

namespace profile_test {

using doctest::Approx;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::IntervalEnd;
using sepcal::ProfileInterval;
using sepcal::Record;
using sepcal::test::Draws;
using sepcal::test::Line;
using sepcal::test::line_record;
using sepcal::test::t_95_8;
using sepcal::test::white;
using sepcal::test::z_95;

namespace {

/// (X'X)^-1's diagonal of a line through the record, and SSE, by sums.
struct LineSums {
  double scale = 0.0;
  double offset = 0.0;
  double square = 0.0;
};
LineSums sums_of(const Record& record) {
  const auto u = record.column("u");
  const auto z = record.column("z");
  const auto n = static_cast<double>(u.size());
  const double mean_u = std::accumulate(u.begin(), u.end(), 0.0) / n;
  const double mean_z = std::accumulate(z.begin(), z.end(), 0.0) / n;
  double uu = 0.0;
  double uz = 0.0;
  double zz = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    uu += (u[i] - mean_u) * (u[i] - mean_u);
    uz += (u[i] - mean_u) * (z[i] - mean_z);
    zz += (z[i] - mean_z) * (z[i] - mean_z);
  }
  return {1.0 / uu, 1.0 / n + mean_u * mean_u / uu, zz - uz * uz / uu};
}

void check_interval(const sepcal::Interval& interval, double value, double half) {
  CHECK(std::abs(interval.lower - (value - half)) < 1e-8 * half);
  CHECK(std::abs(interval.upper - (value + half)) < 1e-8 * half);
}

}  // namespace

TEST_CASE("of a linear model with given noise both intervals are the closed form") {
  const Record record = line_record();
  const LineSums sums = sums_of(record);
  FitOptions options = white();
  options.noise = {{"z", 0.4}};
  const Fit fit = sepcal::fit(Line{}, record, options);
  const auto intervals = sepcal::profile_intervals(Line{}, record, fit, options);
  REQUIRE(intervals.size() == 2);
  const std::array squares{sums.scale, sums.offset};
  for (std::size_t k = 0; k < 2; ++k) {
    const double half = z_95 * 0.4 * std::sqrt(squares[k]);
    CHECK(intervals[k].name == fit.parameters[k].name);
    check_interval(intervals[k].profile, fit.parameters[k].value, half);
    check_interval(intervals[k].gaussian, fit.parameters[k].value, half);
    CHECK(intervals[k].lower_end == IntervalEnd::crossed);
    CHECK(intervals[k].upper_end == IntervalEnd::crossed);
    CHECK(intervals[k].message.empty());
  }
}

TEST_CASE("of a linear model with estimated noise both are Student's") {
  const Record record = line_record();
  const LineSums sums = sums_of(record);
  const Fit fit = sepcal::fit(Line{}, record, white());
  const auto intervals = sepcal::profile_intervals(Line{}, record, fit, white());
  const std::array squares{sums.scale, sums.offset};
  for (std::size_t k = 0; k < 2; ++k) {
    const double half = t_95_8 * std::sqrt(sums.square / 8 * squares[k]);
    check_interval(intervals[k].profile, fit.parameters[k].value, half);
    check_interval(intervals[k].gaussian, fit.parameters[k].value, half);
  }
}

TEST_CASE("of a linear model both are the same whatever the residuals' colour") {
  Draws draws(8);
  const std::vector<double> u = draws.uniform_column(400, -1, 2);
  std::vector<double> z;
  double noise = 0.0;
  for (const double x : u) {
    noise = 0.9 * noise + 0.2 * draws.normal();
    z.push_back(0.7 * x - 0.2 + noise);
  }
  Record record;
  record.add("u", u).add("z", z);
  const Fit fit = sepcal::fit(Line{}, record);
  REQUIRE(fit["c"].standard_error > 2 * fit["c"].standard_error_white);
  for (const ProfileInterval& interval : sepcal::profile_intervals(Line{}, record, fit)) {
    const double half = interval.gaussian.upper - interval.value;
    check_interval(interval.profile, interval.value, half);
  }
}

TEST_CASE("what is held stays held and has no interval") {
  const Record record = line_record();
  FitOptions options = white();
  options.noise = {{"z", 0.4}};
  options.fix = {{"c", -0.2}};
  const Fit fit = sepcal::fit(Line{}, record, options);
  options.fix.clear();  // the fit knows what it held
  const auto intervals = sepcal::profile_intervals(Line{}, record, fit, options);
  REQUIRE(intervals.size() == 1);
  double uu = 0.0;
  for (const double u : record.column("u")) uu += u * u;
  check_interval(intervals[0].profile, fit["s"].value, z_95 * 0.4 / std::sqrt(uu));
}

TEST_CASE("names and levels that make no sense are refused") {
  const Record record = line_record();
  FitOptions options = white();
  const Fit fit = sepcal::fit(Line{}, record, options);
  const auto ask = [&](const Fit& of, sepcal::ProfileOptions asked) {
    (void)sepcal::profile_intervals(Line{}, record, of, options, asked);
  };
  CHECK_THROWS_WITH_AS(ask(fit, {.names = {"k"}}), doctest::Contains("the fit has: s, c"),
                       sepcal::Error);
  CHECK_THROWS_WITH_AS(ask(fit, {.level = 95}), doctest::Contains("between 0 and 1"),
                       sepcal::Error);
  options.fix = {{"c", 0.0}};
  const Fit held = sepcal::fit(Line{}, record, options);
  CHECK_THROWS_WITH_AS(ask(held, {.names = {"c"}}), doctest::Contains("'c' is fixed"),
                       sepcal::Error);
}

TEST_CASE("another record than the fit's is refused") {
  const Fit fit = sepcal::fit(Line{}, line_record(), white());
  Record other;
  other.add("u", {0, 1, 2, 3, 4}).add("z", {9, 8.1, 7, 6.1, 5});
  CHECK_THROWS_WITH_AS((void)sepcal::profile_intervals(Line{}, other, fit, white()),
                       doctest::Contains("no minimum here"), sepcal::Error);
}

TEST_CASE("of a real probe both agree, on any number of threads") {
  const auto flight = sepcal::test::simulate_five_hole(400);
  FitOptions options = white();
  const Fit fit = sepcal::fit(*flight.model, flight.record, options);
  options.threads = 1;
  const auto one = sepcal::profile_intervals(*flight.model, flight.record, fit, options);
  options.threads = 3;
  const auto three = sepcal::profile_intervals(*flight.model, flight.record, fit, options);
  REQUIRE(one.size() == 10);
  for (std::size_t k = 0; k < one.size(); ++k) {
    CAPTURE(one[k].name);
    CHECK(one[k].profile.lower == three[k].profile.lower);
    CHECK(one[k].profile.upper == three[k].profile.upper);
    const double half = one[k].gaussian.upper - one[k].value;
    CHECK(std::abs(one[k].profile.lower - one[k].gaussian.lower) < 0.02 * half);
    CHECK(std::abs(one[k].profile.upper - one[k].gaussian.upper) < 0.02 * half);
  }
}

TEST_CASE("with a loss a linear model's profile has the width of its sandwich, outliers or not") {
  Draws draws(77);
  constexpr std::size_t rows = 4000;
  std::vector<double> u = draws.uniform_column(rows, -1.0, 1.0);
  std::vector<double> z;
  for (std::size_t k = 0; k < rows; ++k) {
    z.push_back(2.0 * u[k] + 1.0 + 0.5 * draws.normal());
    if (k % 20 == 3) z.back() += k % 40 == 3 ? 15.0 : -15.0;
  }
  Record record;
  record.add("u", std::move(u)).add("z", std::move(z));
  for (const sepcal::Loss loss : {sepcal::Loss::huber, sepcal::Loss::cauchy}) {
    CAPTURE(sepcal::to_string(loss));
    const FitOptions options{.loss = loss};
    const Fit fit = sepcal::fit(Line{}, record, options);
    for (const ProfileInterval& interval :
         sepcal::profile_intervals(Line{}, record, fit, options)) {
      CAPTURE(interval.name);
      const double half = z_95 * fit[interval.name].standard_error;
      CHECK(interval.lower_end == IntervalEnd::crossed);
      CHECK(interval.upper_end == IntervalEnd::crossed);
      CHECK(interval.value - interval.profile.lower == Approx(half).epsilon(0.03));
      CHECK(interval.profile.upper - interval.value == Approx(half).epsilon(0.03));
    }
  }
}

TEST_CASE("the prior of the profiled parameter itself narrows its interval") {
  Draws draws(78);
  std::vector<double> u = draws.uniform_column(30, -1.0, 1.0);
  std::vector<double> z;
  for (const double at : u) z.push_back(2.0 * at + 1.0 + 0.5 * draws.normal());
  Record record;
  record.add("u", std::move(u)).add("z", std::move(z));
  FitOptions options;
  options.noise = {{"z", 0.5}};
  options.coloured_errors = false;
  options.prior = {{"s", {2.0, 0.1}}};
  const Fit fit = sepcal::fit(Line{}, record, options);
  for (const ProfileInterval& interval : sepcal::profile_intervals(Line{}, record, fit, options)) {
    const double half = z_95 * fit[interval.name].standard_error;  // linear, R given: exact
    CHECK(interval.profile.lower == Approx(interval.value - half).epsilon(1e-6));
    CHECK(interval.profile.upper == Approx(interval.value + half).epsilon(1e-6));
  }
}

}  // namespace profile_test
