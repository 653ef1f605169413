// SPDX-License-Identifier: BSD-3-Clause
// Tails against mpmath with fifty digits (gammainc, regularized), which scipy.stats.chi2.logsf
// repeats where it reaches; corrections for many tests against published examples and against
// their definitions, which need no sorting.
#include "numerics/tails.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "simulated_records.hpp"

namespace diagnosis_tails_test {

using doctest::Approx;
using namespace sepcal;

namespace {

struct Tail {
  double x;
  double parameter;  // freedom or shape
  double log10_p;
};

void check_close(double found, double expected) {
  CHECK(found == Approx(expected).epsilon(1e-10).scale(1e-3));
}

/// A probability is multiplied by how many are at least as large; none is below a smaller one's.
std::vector<double> holm_by_definition(const std::vector<double>& p) {
  std::vector<double> adjusted(p.size(), 0.0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (const double smaller : p) {
      if (smaller > p[i]) continue;
      const auto left = std::ranges::count_if(p, [&](double q) { return q >= smaller; });
      adjusted[i] = std::max(adjusted[i], std::min(1.0, static_cast<double>(left) * smaller));
    }
  }
  return adjusted;
}

/// The smallest share of false ones in a list that reaches down to at least this probability.
std::vector<double> benjamini_hochberg_by_definition(const std::vector<double>& p) {
  std::vector<double> adjusted(p.size(), 1.0);
  const auto count = static_cast<double>(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (const double last : p) {
      if (last < p[i]) continue;
      const auto listed = std::ranges::count_if(p, [&](double q) { return q <= last; });
      adjusted[i] = std::min(adjusted[i], count * last / static_cast<double>(listed));
    }
  }
  return adjusted;
}

std::vector<double> log10_of(std::vector<double> p) {
  for (double& value : p) value = std::log10(value);
  return p;
}

void check_equal(const std::vector<double>& found, const std::vector<double>& expected) {
  REQUIRE(found.size() == expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    CHECK(found[i] == Approx(expected[i]).epsilon(1e-12).scale(1e-300));
}

}  // namespace

TEST_CASE("the tail of chi-squared, from likely to 1e-2055, few degrees of freedom and many") {
  for (const auto& [x, freedom, expected] :
       {Tail{0.001, 1, -0.011096562482616878}, Tail{3.84, 1, -1.3006521393247689},
        Tail{19.511, 1, -4.999904292818125}, Tail{0.5, 2, -0.10857362047581296},
        Tail{23.0, 2, -4.994386541887396}, Tail{25.19, 3, -4.8510701528485377},
        Tail{20.5, 6, -2.6468254131121667}, Tail{487.3, 6, -101.33978281531684},
        Tail{3247.6, 6, -699.08680972486379}, Tail{3300.0, 12, -702.57633942489652},
        Tail{9.9, 7.9, -0.57860722321640547}, Tail{12.0, 20, -0.038068502717224377},
        Tail{31.41, 20, -1.3009844909149244}, Tail{1000.0, 1000, -0.30622658771901512},
        Tail{1300.0, 1000, -9.4100798178760583}, Tail{6000.0, 1000, -699.10840518424196},
        Tail{100'500.0, 100'000, -0.87990401744680208},
        Tail{102'000.0, 100'000, -5.3553704756850804},
        Tail{150'000.0, 100'000, -2055.2466925635357}}) {
    CAPTURE(x);
    CAPTURE(freedom);
    check_close(numerics::log10_chi_squared_tail(x, freedom), expected);
  }
}

TEST_CASE("the tail of a gamma variable on either side of where series and fraction meet") {
  for (const auto& [x, shape, expected] :
       {Tail{1e-8, 0.3, -0.0019307633980284571}, Tail{1.2999, 0.3, -1.2580582019319048},
        Tail{1.3001, 0.3, -1.2581775155377115}, Tail{40.0, 0.3, -18.976479433338455},
        Tail{3.4999999, 2.5, -0.65631511576703739}, Tail{3.5, 2.5, -0.65631514504458085},
        Tail{3.5000001, 2.5, -0.6563151743221246}, Tail{900.0, 17.25, -356.47651420973981},
        Tail{10.995, 10.0, -0.46717746814434067}, Tail{11.0, 10.0, -0.46786930991307192},
        Tail{11.005, 10.0, -0.46856162539517662}}) {
    CAPTURE(x);
    CAPTURE(shape);
    check_close(numerics::log10_gamma_tail(shape, x), expected);
  }
}

TEST_CASE("the tail of Fisher's F, against scipy.stats.f.logsf") {
  struct Fisher {
    double x;
    double k;
    double freedom;
    double log10_p;
  };
  for (const auto& [x, k, freedom, expected] :
       {Fisher{0.3, 2.0, 10.0, -0.126529326324}, Fisher{1.0, 1.0, 3.0, -0.407820777956},
        Fisher{4.0, 7.0, 500.0, -3.54558228615}, Fisher{60.0, 7.0, 600.0, -64.415355354},
        Fisher{3000.0, 3.0, 40.0, -46.3721059289}, Fisher{1.5, 30.0, 4.5, -0.43984161106},
        Fisher{0.99, 7.0, 60000.0, -0.360298192549}, Fisher{40.0, 7.0, 60000.0, -55.8132770548}}) {
    CAPTURE(x);
    CAPTURE(k);
    CHECK(numerics::log10_f_tail(x, k, freedom) == Approx(expected).epsilon(1e-9));
  }
  // Many degrees of freedom: chi-squared over k.
  CHECK(numerics::log10_f_tail(5.0, 4.0, 1e9) ==
        Approx(numerics::log10_chi_squared_tail(20.0, 4.0)).epsilon(1e-6));
  CHECK(numerics::log10_f_tail(0.0, 2.0, 5.0) == 0.0);
}

TEST_CASE("the ends of the axis") {
  CHECK(numerics::log10_gamma_tail(2.0, 0.0) == 0.0);
  CHECK(numerics::log10_gamma_tail(2.0, -1.0) == 0.0);
  CHECK(numerics::log10_gamma_tail(2.0, infinity) == -infinity);
  CHECK(numerics::log10_chi_squared_tail(0.0, 3.0) == 0.0);
}

TEST_CASE("Holm's adjusted probabilities, by hand") {
  check_equal(numerics::adjust_by_holm(log10_of({0.01, 0.04, 0.03, 0.005})),
              {0.03, 0.06, 0.06, 0.02});
  check_equal(numerics::adjust_by_holm(log10_of({0.5, 0.6})), {1.0, 1.0});
  check_equal(numerics::adjust_by_holm(log10_of({0.02})), {0.02});
  CHECK(sepcal::numerics::adjust_by_holm({}).empty());
}

TEST_CASE("the example of Benjamini and Hochberg (1995): four are listed, Holm takes three") {
  const std::vector<double> log10_p =
      log10_of({0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240,
                0.4262, 0.5719, 0.6528, 0.7590, 1.0000});
  const std::vector<double> listed = numerics::adjust_by_benjamini_hochberg(log10_p);
  const std::vector<double> holm = numerics::adjust_by_holm(log10_p);
  const auto within = [](double p) { return p < 0.05; };
  CHECK(std::ranges::count_if(listed, within) == 4);
  CHECK(std::ranges::count_if(holm, within) == 3);
  CHECK(listed[3] == Approx(0.0095 * 15 / 4));
  CHECK(listed[5] == Approx(0.0298 * 15 / 7));  // the next one's, which is smaller
  CHECK(holm[2] == Approx(0.0019 * 13));
}

TEST_CASE("both corrections in any order, with ties, are what they are defined to be") {
  test::Draws draws(7);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<double> p;
    for (int i = 0; i < 30; ++i) p.push_back(std::pow(draws.uniform(0.0, 1.0), 4));
    p[4] = p[11] = p[23];
    p[0] = 1.0;
    check_equal(numerics::adjust_by_holm(log10_of(p)), holm_by_definition(p));
    check_equal(numerics::adjust_by_benjamini_hochberg(log10_of(p)),
                benjamini_hochberg_by_definition(p));
  }
}

TEST_CASE("probabilities too small for a double are zero and keep their places") {
  const std::vector<double> log10_p{-2.0, -700.0, -699.0, -1.0};
  check_equal(numerics::adjust_by_holm(log10_p), {0.02, 0.0, 0.0, 0.1});
  check_equal(numerics::adjust_by_benjamini_hochberg(log10_p), {0.04 / 3, 0.0, 0.0, 0.1});
  check_equal(numerics::adjust_by_holm({-300.0, 0.0}), {2e-300, 1.0});
}

}  // namespace diagnosis_tails_test
