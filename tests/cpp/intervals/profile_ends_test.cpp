// SPDX-License-Identifier: BSD-3-Clause
// Where a profile interval ends where the likelihood is no parabola: against the crossings of the
// sum of squares itself, by bisection; at bounds, and nowhere.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>

#include "profile_records.hpp"
#include "sepcal/profile.hpp"
#include "small_models.hpp"

namespace profile_ends_test {

using doctest::Approx;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::IntervalEnd;
using sepcal::ProfileInterval;
using sepcal::Quantity;
using sepcal::Record;
using sepcal::test::cross;
using sepcal::test::Growth;
using sepcal::test::growth_record;
using sepcal::test::Line;
using sepcal::test::line_record;
using sepcal::test::t_95_8;
using sepcal::test::white;
using sepcal::test::z_95;

namespace {

constexpr double t_95_9 = 2.2621571628540993;  // SciPy, 9 degrees of freedom

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

double growth_square(const Record& record, double c) {
  const auto u = record.column("u");
  const auto z = record.column("z");
  double square = 0.0;
  for (std::size_t i = 0; i < u.size(); ++i) square += std::pow(z[i] - std::exp(c * u[i]), 2);
  return square;
}

}  // namespace

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

}  // namespace profile_ends_test
