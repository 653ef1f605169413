// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/quantiles.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "numerics/tails.hpp"
#include "sepcal/error.hpp"

namespace sepcal::numerics {
namespace {

void check_level(double level) {
  if (level > 0 && level < 1) return;
  throw Error("level is " + std::to_string(level) +
              "; it must lie between 0 and 1, as 0.95 does for 95 %");
}

/// Where `tail`, which falls from 1 to 0, is `probability`.
double solve(const std::function<double(double)>& tail, double probability) {
  double low = 0.0;
  double high = 1.0;
  while (tail(high) > probability && high < std::numeric_limits<double>::max() / 4) high *= 2.0;
  for (int i = 0; i < 200 && high - low > 0; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (tail(middle) > probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// P(|T| > t) = I_x(freedom / 2, 1/2) at x = freedom / (freedom + t^2) (A&S 26.7.1).
double student_tail(double t, double freedom) {
  const double a = 0.5 * freedom;
  const double y = t * t / (freedom + t * t);
  const double x = freedom / (freedom + t * t);
  if (y == 0) return 1.0;
  const double front = std::exp(std::lgamma(a + 0.5) - std::lgamma(a) + a * std::log(x)) *
                       std::sqrt(y * std::numbers::inv_pi);
  if (x < (a + 1.0) / (a + 2.5)) return front * beta_fraction(a, 0.5, x) / a;
  return 1.0 - front * beta_fraction(0.5, a, y) / 0.5;
}

/// The expansion about the normal's in 1 / freedom (A&S 26.7.5).
double expand_about_normal(double z, double freedom) {
  const double s = z * z;
  const double g1 = (s + 1.0) * z / 4.0;
  const double g2 = ((5.0 * s + 16.0) * s + 3.0) * z / 96.0;
  const double g3 = (((3.0 * s + 19.0) * s + 17.0) * s - 15.0) * z / 384.0;
  const double g4 = ((((79.0 * s + 776.0) * s + 1482.0) * s - 1920.0) * s - 945.0) * z / 92160.0;
  return z + (g1 + (g2 + (g3 + g4 / freedom) / freedom) / freedom) / freedom;
}

}  // namespace

double normal_reach(double level) {
  check_level(level);
  return solve([](double z) { return std::erfc(z / std::numbers::sqrt2); }, 1.0 - level);
}

double normal_probability(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

double normal_quantile(double p) {
  if (p > 0.5) return -normal_quantile(1.0 - p);
  // A rational start that is good to 5e-4 (Abramowitz & Stegun 26.2.23) and cubic steps to the
  // root.
  const double t = std::sqrt(-2.0 * std::log(p));
  double x = t - (2.515517 + t * (0.802853 + t * 0.010328)) /
                     (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
  x = -x;
  for (int step = 0; step < 3; ++step) {
    const double density = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    const double error = (normal_probability(x) - p) / density;
    x -= error / (1.0 + 0.5 * x * error);
  }
  return x;
}

double student_reach(double level, double freedom) {
  constexpr double many = 1000.0;  // beyond it the logarithms of gamma lose digits
  check_level(level);
  if (!(freedom > 0)) return std::numeric_limits<double>::infinity();
  if (freedom > many) return expand_about_normal(normal_reach(level), freedom);
  return solve([freedom](double t) { return student_tail(t, freedom); }, 1.0 - level);
}

}  // namespace sepcal::numerics
