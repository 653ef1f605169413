// SPDX-License-Identifier: BSD-3-Clause
// Ranges hold what they are said to hold: every operation against the same in long double at random
// points, and derivatives of models against dual numbers.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/enclosed_dual.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/detail/nested_dual.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/pitot_static.hpp"

namespace enclosure_test {

using sepcal::EnclosedDual;
using sepcal::EnclosedRows;
using sepcal::Enclosure;
using sepcal::NestedDual;
using sepcal::Vec;

namespace {

Enclosure draw_range(std::mt19937_64& generator, double most_width) {
  std::uniform_real_distribution<double> ends(-4.0, 4.0);
  std::uniform_real_distribution<double> widths(0.0, most_width);
  const double lower = ends(generator);
  return {lower, lower + widths(generator)};
}

double draw_within(const Enclosure& range, std::mt19937_64& generator) {
  return std::uniform_real_distribution<double>(range.lower(), range.upper())(generator);
}

bool holds(const Enclosure& range, long double value) {
  return static_cast<long double>(range.lower()) <= value &&
         value <= static_cast<long double>(range.upper());
}

/// What a model gives in ranges, against what it and its derivatives are at points within.
template <class Model, int N2, class Draw>
void check_model(const Draw& draw_inputs, const std::vector<Enclosure>& whole, double width,
                 std::uint64_t seed, const Model& model = {}, int trials = 300) {
  using Sizes = sepcal::Sizes<Model>;
  std::mt19937_64 generator(seed);
  for (int trial = 0; trial < trials; ++trial) {
    const auto u = draw_inputs(generator);
    std::vector<Enclosure> ranges;
    Vec<EnclosedDual<N2>, N2> box;
    for (int j = 0; j < N2; ++j) {
      const double lower = draw_within(whole[static_cast<std::size_t>(j)], generator);
      ranges.emplace_back(lower, lower + width);
      box[j] = EnclosedDual<N2>(ranges.back(), j);
    }
    const auto enclosed = model.at(Vec<Enclosure, Sizes::n_u>(u.template cast<Enclosure>()), box);
    for (int point = 0; point < 10; ++point) {
      Vec<NestedDual<N2>, N2> x;
      for (int j = 0; j < N2; ++j) {
        x[j] = NestedDual<N2>(draw_within(ranges[static_cast<std::size_t>(j)], generator), j);
      }
      const auto exact = model.at(u, x);
      constexpr double rounding = 1e-12;  // of the dual numbers, which are not widened
      const auto near = [&](const Enclosure& range, double value) {
        const double slack = rounding * (1.0 + std::abs(value));
        return range.lower() - slack <= value && value <= range.upper() + slack;
      };
      const auto check = [&](const EnclosedDual<N2>& range, const NestedDual<N2>& value) {
        CHECK(near(range.value(), value.value()));
        for (int j = 0; j < N2; ++j) {
          CHECK(near(range.slope(j), value.slope(j)));
          for (int k = 0; k <= j; ++k) {
            CHECK(near(range.curvature(j, k), value.second_derivative(j, k)));
          }
        }
      };
      for (int i = 0; i < Sizes::n_z; ++i) {
        for (int l = 0; l < Sizes::n_1; ++l) check(enclosed.A(i, l), exact.A(i, l));
        check(enclosed.b[i], exact.b[i]);
      }
    }
  }
}

}  // namespace

TEST_CASE("operations hold what long double says at points within") {
  std::mt19937_64 generator(3);
  for (int trial = 0; trial < 20000; ++trial) {
    const double width = trial % 3 == 0 ? 0.0 : trial % 3 == 1 ? 1e-9 : 9.0;
    const Enclosure x = draw_range(generator, width);
    const Enclosure y = draw_range(generator, width);
    const auto a = static_cast<long double>(draw_within(x, generator));
    const auto b = static_cast<long double>(draw_within(y, generator));
    CHECK(holds(x + y, a + b));
    CHECK(holds(x - y, a - b));
    CHECK(holds(x * y, a * b));
    CHECK(holds(square(x), a * a));
    CHECK(holds(cos(x), std::cos(a)));
    CHECK(holds(sin(x), std::sin(a)));
    CHECK(holds(exp(x), std::exp(a)));
    if (!y.contains(0.0)) CHECK(holds(x / y, a / b));
    if (x.lower() > 0.0) {
      CHECK(holds(sqrt(x), std::sqrt(a)));
      CHECK(holds(log(x), std::log(a)));
    }
  }
}

TEST_CASE("ranges are hardly wider than what they hold") {
  const Enclosure x(0.3, 0.4);
  CHECK(sin(x).upper() - std::sin(0.4) < 1e-14);
  CHECK(std::sin(0.3) - sin(x).lower() < 1e-14);
  CHECK(cos(Enclosure(3.0, 3.3)).lower() == -1.0);
  CHECK(cos(Enclosure(-0.1, 0.1)).upper() == 1.0);
  CHECK(cos(Enclosure(0.0, 7.0)).lower() == -1.0);
  CHECK(square(Enclosure(-1.0, 2.0)).lower() == 0.0);
  CHECK(Enclosure(0.1, 0.1).magnitude() == 0.1);
}

TEST_CASE("what is not known is the whole line") {
  const Enclosure over_zero(-1.0, 1.0);
  CHECK_FALSE((Enclosure(1.0) / over_zero).is_finite());
  CHECK_FALSE(log(over_zero).is_finite());
  CHECK_FALSE(Enclosure(std::nan("")).is_finite());
  CHECK_FALSE((Enclosure(1e300) * Enclosure(1e300)).is_finite());
  CHECK(sqrt(over_zero).lower() == 0.0);
  CHECK(cos(Enclosure(1e9)).lower() == -1.0);
}

TEST_CASE("models in ranges hold their values, slopes and second derivatives") {
  const auto angle = [](std::mt19937_64& generator) {
    return Vec<double, 1>(std::uniform_real_distribution<double>(1.0, 10.0)(generator));
  };
  for (const double width : {0.0, 1e-6, 0.05, 0.6}) {
    check_model<sepcal::ScalarExample1, 1>(angle, {{-0.5, 0.5}}, width, 5);
    check_model<sepcal::ScalarExample2, 2>(angle, {{-0.5, 0.5}, {-1.0, 1.0}}, width, 6);
    const auto flown = [](std::mt19937_64& generator) {
      std::uniform_real_distribution<double> speed(-30.0, 30.0);
      Vec<double, 7> u;
      u << speed(generator), speed(generator), speed(generator), 0.0, 0.0, 0.0, 1.2;
      return u;
    };
    check_model<sepcal::PitotStatic, 3>(flown, {{-15.0, 15.0}, {-15.0, 15.0}, {-3.0, 3.0}}, width,
                                        7);
    const auto turned = [](std::mt19937_64& generator) {
      std::uniform_real_distribution<double> field(-60.0, 60.0);
      return Vec<double, 3>(field(generator), field(generator), field(generator));
    };
    check_model<sepcal::Magnetometer, 6>(turned, std::vector(6, Enclosure(-0.5, 0.5)), width, 8, {},
                                         30);
    const auto probed = [](std::mt19937_64& generator) {
      std::uniform_real_distribution<double> unit(-1.0, 1.0);
      Vec<double, 14> u = Vec<double, 14>::Zero();
      for (int i = 0; i < 6; ++i) u[i] = unit(generator);
      u.segment<5>(6) << 90200.0 + 100.0 * unit(generator), 90000.0, 100.0 * unit(generator),
          100.0 * unit(generator), 1.2;
      return u;
    };
    check_model<sepcal::FiveHoleProbe, 5>(probed, std::vector(5, Enclosure(-0.3, 0.3)), width, 9,
                                          {4.5, 4.6, {0.35, -0.1, -0.02}}, 30);
    const auto with_vanes = [](std::mt19937_64& generator) {
      std::uniform_real_distribution<double> unit(-1.0, 1.0);
      Vec<double, 13> u = Vec<double, 13>::Zero();
      for (int i = 0; i < 6; ++i) u[i] = unit(generator);
      u.segment<4>(6) << 25.0 + 10.0 * unit(generator), 0.2 * unit(generator),
          0.2 * unit(generator), 1.2;
      return u;
    };
    check_model<sepcal::VaneBoom, 5>(with_vanes, std::vector(5, Enclosure(-0.3, 0.3)), width, 10,
                                     {{0.35, -0.1, -0.02}}, 30);
  }
}

}  // namespace enclosure_test
