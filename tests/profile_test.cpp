// SPDX-License-Identifier: BSD-3-Clause
// Profile-likelihood intervals against closed forms where the model is linear, and against the
// crossings of the sum of squares itself, by bisection, where it is not.
#include "sepcal/profile.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "sepcal/error.hpp"
#include "simulated_records.hpp"
#include "small_models.hpp"

using doctest::Approx;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::IntervalEnd;
using sepcal::ProfileInterval;
using sepcal::Quantity;
using sepcal::Record;
using sepcal::test::Draws;
using sepcal::test::Growth;
using sepcal::test::Line;

namespace {

constexpr double z_95 = 1.959963984540054;    // SciPy
constexpr double t_95_8 = 2.306004135204166;  // 8 degrees of freedom
constexpr double t_95_9 = 2.2621571628540993;

/// z = cos(c u), whose cost has more than one minimum.
struct Wave {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array<Quantity, 0> linear{};
  static constexpr std::array nonlinear{Quantity{"c", "1", 0.1, 1.75}};
  template <class U, class X>
  sepcal::Affine<X, 1, 0> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::cos;
    sepcal::Affine<X, 1, 0> z;
    z.b << cos(xi2[0] * u[0]);
    return z;
  }
};

/// z = s u / (K + u), K not bounded above (Michaelis & Menten).
struct Saturation {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"s", "1"}};
  static constexpr std::array nonlinear{Quantity{"K", "1", 0.01, sepcal::infinity}};
  template <class U, class X>
  sepcal::Affine<X, 1, 1> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    sepcal::Affine<X, 1, 1> z;
    z.A << u[0] / (xi2[0] + u[0]);
    z.b << X(0.0);
    return z;
  }
};

FitOptions white() {
  FitOptions options;
  options.samples = 50;
  options.coloured_errors = false;
  return options;
}

/// Ten samples of a line, with noise that is anything but small.
Record line_record() {
  Draws draws(3);
  const std::vector<double> u = draws.uniform_column(10, -1, 2);
  std::vector<double> z;
  for (const double x : u) z.push_back(0.7 * x - 0.2 + 0.5 * draws.normal());
  Record record;
  record.add("u", u).add("z", z);
  return record;
}

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

Record growth_record(double noise) {
  Draws draws(5);
  const std::vector<double> u = draws.uniform_column(10, 0, 2);
  std::vector<double> z;
  for (const double x : u) z.push_back(std::exp(0.6 * x) + noise * draws.normal());
  Record record;
  record.add("u", u).add("z", z);
  return record;
}

double growth_square(const Record& record, double c) {
  const auto u = record.column("u");
  const auto z = record.column("z");
  double square = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) square += std::pow(z[i] - std::exp(c * u[i]), 2);
  return square;
}

/// Where a function that rises away from `inside` crosses `height`, between the two.
double cross(const std::function<double(double)>& f, double height, double inside, double outside) {
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (inside + outside);
    (f(middle) < height ? inside : outside) = middle;
  }
  return inside;
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

TEST_CASE("a parameter that is alone: the F test's crossings of the sum of squares") {
  const Record record = growth_record(0.3);
  const Fit fit = sepcal::fit(Growth{}, record, white());
  const auto square = [&](double c) { return growth_square(record, c); };
  const double height = square(fit["c"].value) * (1 + t_95_9 * t_95_9 / 9);
  const auto interval = sepcal::profile_intervals(Growth{}, record, fit, white()).at(0);
  CHECK(interval.profile.lower == Approx(cross(square, height, fit["c"].value, -1)).epsilon(1e-8));
  CHECK(interval.profile.upper == Approx(cross(square, height, fit["c"].value, 1)).epsilon(1e-8));
  // The likelihood is no parabola: the lower end is the farther one.
  CHECK(interval.value - interval.profile.lower > 1.05 * (interval.profile.upper - interval.value));
}

TEST_CASE("at a bound: one end is the bound, the other where the likelihood has fallen") {
  const Record record = growth_record(0.3);
  FitOptions options = white();
  const double best = sepcal::fit(Growth{}, record, options)["c"].value;
  const double bound = best - 0.05;
  options.bounds = {{"c", {-1, bound}}};
  const Fit fit = sepcal::fit(Growth{}, record, options);
  REQUIRE(fit["c"].at_bound);
  const auto interval = sepcal::profile_intervals(Growth{}, record, fit, options).at(0);
  CHECK(std::isnan(interval.gaussian.lower));
  CHECK(std::isnan(interval.gaussian.upper));
  CHECK(interval.upper_end == IntervalEnd::bound);
  CHECK(interval.profile.upper == bound);
  CHECK(interval.lower_end == IntervalEnd::crossed);
  const auto square = [&](double c) { return growth_square(record, c); };
  const double height = square(bound) * (1 + t_95_9 * t_95_9 / 9);
  CHECK(interval.profile.lower == Approx(cross(square, height, bound, -1)).epsilon(1e-8));
}

TEST_CASE("a bound within the interval ends it, and so do those of others") {
  // The line's scale and offset trade against each other: the bound of one shortens the other's.
  const Record record = line_record();
  FitOptions options = white();
  const Fit free = sepcal::fit(Line{}, record, options);
  options.bounds = {{"s", {free["s"].value - 0.01, 10}}};
  const Fit fit = sepcal::fit(Line{}, record, options);
  const auto intervals = sepcal::profile_intervals(Line{}, record, fit, options);
  CHECK(intervals[0].lower_end == IntervalEnd::bound);
  CHECK(intervals[0].profile.lower == free["s"].value - 0.01);
  CHECK(intervals[0].upper_end == IntervalEnd::crossed);
  // c at t, s the best within its bounds: SSE by hand.
  const auto square = [&](double c) {
    const auto u = record.column("u");
    const auto z = record.column("z");
    double uu = 0.0;
    double uz = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) uu += u[i] * u[i], uz += u[i] * (z[i] - c);
    const double s = std::max(uz / uu, free["s"].value - 0.01);
    double sum = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) sum += std::pow(z[i] - c - s * u[i], 2);
    return sum;
  };
  const double height = square(fit["c"].value) * (1 + t_95_8 * t_95_8 / 8);
  CHECK(intervals[1].profile.lower ==
        Approx(cross(square, height, fit["c"].value, -9)).epsilon(1e-7));
  CHECK(intervals[1].profile.upper ==
        Approx(cross(square, height, fit["c"].value, 9)).epsilon(1e-7));
}

TEST_CASE("what nothing determines is open") {
  Record flat;
  flat.add("u", std::vector<double>(6, 0.0)).add("z", {1.0, 1.2, 0.9, 1.1, 1.0, 0.8});
  FitOptions options = white();
  options.noise = {{"z", 0.1}};
  const Fit fit = sepcal::fit(Line{}, flat, options);
  const auto intervals = sepcal::profile_intervals(Line{}, flat, fit, options);
  CHECK(intervals[0].lower_end == IntervalEnd::open);
  CHECK(intervals[0].upper_end == IntervalEnd::open);
  CHECK(intervals[0].profile.upper == sepcal::infinity);
  // The loose prior that holds s while the fit runs leaves its trace in the ninth digit.
  CHECK(intervals[1].profile.lower == Approx(1.0 - z_95 * 0.1 / std::sqrt(6.0)).epsilon(1e-6));
  CHECK(intervals[1].profile.upper == Approx(1.0 + z_95 * 0.1 / std::sqrt(6.0)).epsilon(1e-6));
}

TEST_CASE("a likelihood that levels off below the height is open on that side alone") {
  Record record;
  record.add("u", {0.5, 1, 1.5, 2, 2.5, 3}).add("z", {0.42, 0.78, 1.2, 1.45, 1.7, 2.1});
  FitOptions options = white();
  options.noise = {{"z", 0.2}};
  options.start = {{"K", 5.0}};
  const Fit fit = sepcal::fit(Saturation{}, record, options);
  const auto interval =
      sepcal::profile_intervals(Saturation{}, record, fit, options, {.names = {"K"}}).at(0);
  CHECK(interval.upper_end == IntervalEnd::open);
  CHECK(interval.profile.upper == sepcal::infinity);
  CHECK(interval.lower_end == IntervalEnd::crossed);
  const auto square = [&](double K) {
    const auto u = record.column("u");
    const auto z = record.column("z");
    double az = 0.0;
    double aa = 0.0;
    double zz = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      const double a = u[i] / (K + u[i]);
      az += a * z[i], aa += a * a, zz += z[i] * z[i];
    }
    return (zz - az * az / aa) / 0.04;
  };
  const double height = square(fit["K"].value) + z_95 * z_95;
  REQUIRE(square(1e6) < height);
  // The fit calls K open, and a loose prior pulls its estimate a little.
  CHECK(interval.profile.lower ==
        Approx(cross(square, height, fit["K"].value, 0.01)).epsilon(1e-3));
  CHECK(interval.message.empty());
}

TEST_CASE("a refit below the fit is said to be another minimum") {
  // By a scan: SSE is 3.142 at its local minimum c = 0.738, at most 5.4 between the bounds, and
  // zero at c = 1.75. With noise of 2 nothing in between is 3.84 above the local minimum.
  Record record;
  record.add("u", {1, 2, 3}).add("z", {std::cos(1.75), std::cos(3.5), std::cos(5.25)});
  FitOptions options = white();
  options.noise = {{"z", 2.0}};
  options.start = {{"c", 0.7}};
  const Fit fit = sepcal::fit(Wave{}, record, options);
  REQUIRE(fit["c"].value == Approx(0.738).epsilon(1e-3));
  const auto interval = sepcal::profile_intervals(Wave{}, record, fit, options).at(0);
  CHECK(interval.message.find("not the lowest minimum: with c held at 1.") != std::string::npos);
  CHECK(interval.lower_end == IntervalEnd::bound);
  CHECK(interval.upper_end == IntervalEnd::bound);
}

TEST_CASE("as many parameters as measurements: nothing ends an interval but a bound") {
  Record record;
  record.add("u", {0, 1}).add("z", {1, 3});
  FitOptions options = white();
  options.bounds = {{"s", {-5, 5}}};
  const Fit fit = sepcal::fit(Line{}, record, options);
  const auto intervals = sepcal::profile_intervals(Line{}, record, fit, options);
  CHECK(intervals[0].lower_end == IntervalEnd::bound);
  CHECK(intervals[0].upper_end == IntervalEnd::bound);
  CHECK(intervals[1].lower_end == IntervalEnd::open);
}

TEST_CASE("what is held stays held and has no interval") {
  const Record record = line_record();
  FitOptions options = white();
  options.noise = {{"z", 0.4}};
  options.fixed = {{"c", -0.2}};
  const Fit fit = sepcal::fit(Line{}, record, options);
  options.fixed.clear();  // the fit knows what it held
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
  options.fixed = {{"c", 0.0}};
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

TEST_CASE("what is known of the profiled parameter itself narrows its interval") {
  Draws draws(78);
  std::vector<double> u = draws.uniform_column(30, -1.0, 1.0);
  std::vector<double> z;
  for (const double at : u) z.push_back(2.0 * at + 1.0 + 0.5 * draws.normal());
  Record record;
  record.add("u", std::move(u)).add("z", std::move(z));
  FitOptions options;
  options.noise = {{"z", 0.5}};
  options.coloured_errors = false;
  options.knowledge = {{"s", {2.0, 0.1}}};
  const Fit fit = sepcal::fit(Line{}, record, options);
  for (const ProfileInterval& interval : sepcal::profile_intervals(Line{}, record, fit, options)) {
    const double half = z_95 * fit[interval.name].standard_error;  // linear, R given: exact
    CHECK(interval.profile.lower == Approx(interval.value - half).epsilon(1e-6));
    CHECK(interval.profile.upper == Approx(interval.value + half).epsilon(1e-6));
  }
}
