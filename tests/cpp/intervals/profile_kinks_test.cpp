// SPDX-License-Identifier: BSD-3-Clause
// Profile intervals past what stops the other parameters: their bounds, and where the model is no
// number.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "profile_records.hpp"
#include "sepcal/profile.hpp"

namespace profile_kinks_test {

using doctest::Approx;
using sepcal::Fit;
using sepcal::FitOptions;
using sepcal::IntervalEnd;
using sepcal::Quantity;
using sepcal::Record;
using sepcal::test::cross;
using sepcal::test::growth_record;
using sepcal::test::t_95_8;
using sepcal::test::white;

namespace {

/// z = s exp(c u).
struct ScaledGrowth {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"s", "1"}};
  static constexpr std::array nonlinear{Quantity{"c", "1", -3, 3}};
  template <class U, class X>
  sepcal::Affine<X, 1, 1> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::exp;
    sepcal::Affine<X, 1, 1> z;
    z.A << exp(xi2[0] * u[0]);
    z.b << X(0.0);
    return z;
  }
};

/// z = s u + sqrt(1 - c), not a number beyond c = 1.
struct Root {
  static constexpr std::array inputs{Quantity{"u", "1"}};
  static constexpr std::array outputs{Quantity{"z", "1"}};
  static constexpr std::array linear{Quantity{"s", "1"}};
  static constexpr std::array nonlinear{Quantity{"c", "1", -3, 3}};
  template <class U, class X>
  sepcal::Affine<X, 1, 1> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::sqrt;
    sepcal::Affine<X, 1, 1> z;
    z.A << X(u[0]);
    z.b << sqrt(1.0 - xi2[0]);
    return z;
  }
};

}  // namespace

TEST_CASE("another parameter meets its bound on the way: the profile has a kink there") {
  // The larger c, the smaller s: both ends lie beyond a bound of s, by the SSE of the best s
  // within.
  const Record record = growth_record(0.3);
  FitOptions options = white();
  const double best = sepcal::fit(ScaledGrowth{}, record, options)["s"].value;
  options.bounds = {{"s", {best - 0.1, best + 0.1}}};
  const Fit fit = sepcal::fit(ScaledGrowth{}, record, options);
  REQUIRE_FALSE(fit["s"].at_bound);
  const auto free_scale = [&](double c) {
    const auto u = record.column("u");
    const auto z = record.column("z");
    double az = 0.0;
    double aa = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      az += std::exp(c * u[i]) * z[i], aa += std::exp(2 * c * u[i]);
    }
    return az / aa;
  };
  const auto square = [&](double c) {
    const auto u = record.column("u");
    const auto z = record.column("z");
    const double s = std::clamp(free_scale(c), best - 0.1, best + 0.1);
    double sum = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) sum += std::pow(z[i] - s * std::exp(c * u[i]), 2);
    return sum;
  };
  const double height = square(fit["c"].value) * (1 + t_95_8 * t_95_8 / 8);
  const double lower = cross(square, height, fit["c"].value, -3);
  const double upper = cross(square, height, fit["c"].value, 3);
  REQUIRE(free_scale(lower) > best + 0.1);
  REQUIRE(free_scale(upper) < best - 0.1);
  for (const auto method : {sepcal::SecondStage::joint, sepcal::SecondStage::projected}) {
    options.second_stage = method;
    const auto interval =
        sepcal::profile_intervals(ScaledGrowth{}, record, fit, options, {.names = {"c"}}).at(0);
    CHECK(interval.lower_end == IntervalEnd::crossed);
    CHECK(interval.upper_end == IntervalEnd::crossed);
    CHECK(interval.profile.lower == Approx(lower).epsilon(1e-7));
    CHECK(interval.profile.upper == Approx(upper).epsilon(1e-7));
  }
}

TEST_CASE("an end that could not be found says where and why") {
  Record record;
  record.add("u", {-2, -1, 0, 1, 2, 3}).add("z", {-1.9, -1.3, 0.5, 1.2, 1.7, 3.3});
  FitOptions options = white();
  options.noise = {{"z", 0.5}};
  options.start = {{"c", 0.9}};
  const Fit fit = sepcal::fit(Root{}, record, options);
  REQUIRE(fit.status == sepcal::FitStatus::converged);
  const auto interval =
      sepcal::profile_intervals(Root{}, record, fit, options, {.names = {"c"}}).at(0);
  CHECK(interval.upper_end == IntervalEnd::failed);
  CHECK(std::isnan(interval.profile.upper));
  CHECK(interval.message.find("the upper end could not be found: with c held at 0.99") !=
        std::string::npos);
  CHECK(interval.message.find("the other parameters could not be fitted; bound c") !=
        std::string::npos);
}

}  // namespace profile_kinks_test
