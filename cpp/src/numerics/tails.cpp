// SPDX-License-Identifier: BSD-3-Clause
#include "numerics/tails.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace sepcal::numerics {
namespace {

/// P(a, x) by its series, for x below a + 1 (Abramowitz & Stegun 6.5.29).
double lower_series(double a, double x) {
  double term = 1.0 / a;
  double sum = term;
  for (int n = 1; n < 10'000 && term > 1e-17 * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return sum * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

/// The continued fraction of Q(a, x) without its leading factor (A&S 6.5.31, by Lentz).
double upper_fraction(double a, double x) {
  constexpr double tiny = 1e-300;
  double b = x + 1.0 - a;
  double c = 1.0 / tiny;
  double d = 1.0 / b;
  double h = d;
  for (int n = 1; n < 10'000; ++n) {
    const double an = -n * (n - a);
    b += 2.0;
    d = an * d + b;
    if (std::abs(d) < tiny) d = tiny;
    c = b + an / c;
    if (std::abs(c) < tiny) c = tiny;
    d = 1.0 / d;
    h *= d * c;
    if (std::abs(d * c - 1.0) < 1e-15) break;
  }
  return h;
}

/// ln of the incomplete beta function I_x(a, b), for such x; y = 1 - x.
double log_beta_ratio(double a, double b, double x, double y) {
  return a * std::log(x) + b * std::log(y) + std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
         std::log(beta_fraction(a, b, x) / a);
}

/// Indices from the smallest value to the largest.
std::vector<std::size_t> ascending(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return values[i]; });
  return order;
}

double times(double log10_p, double factor) {
  return std::min(1.0, std::pow(10.0, log10_p + std::log10(factor)));
}

}  // namespace

double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300;
  const auto away_from_zero = [](double value) { return std::abs(value) < tiny ? tiny : value; };
  double c = 1.0;
  double d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
  double h = d;
  for (int m = 1; m < 10'000; ++m) {
    const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
    d = 1.0 / away_from_zero(1.0 + even * d);
    c = away_from_zero(1.0 + even / c);
    h *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
    d = 1.0 / away_from_zero(1.0 + odd * d);
    c = away_from_zero(1.0 + odd / c);
    h *= d * c;
    if (std::abs(d * c - 1.0) < 1e-15) break;
  }
  return h;
}

double log10_gamma_tail(double shape, double x) {
  if (!(x > 0)) return 0.0;
  if (std::isinf(x)) return -std::numeric_limits<double>::infinity();
  if (x < shape + 1.0)
    return std::log1p(-std::min(lower_series(shape, x), 1.0)) / std::numbers::ln10;
  const double log_q =
      -x + shape * std::log(x) - std::lgamma(shape) + std::log(upper_fraction(shape, x));
  return std::min(0.0, log_q / std::numbers::ln10);
}

double log10_chi_squared_tail(double x, double freedom) {
  return log10_gamma_tail(0.5 * freedom, 0.5 * x);
}

double log10_f_tail(double x, double k, double freedom) {
  if (!(x > 0)) return 0.0;
  if (std::isinf(x)) return -std::numeric_limits<double>::infinity();
  const double a = 0.5 * freedom;
  const double b = 0.5 * k;
  const double at = freedom / (freedom + k * x);
  const double rest = k * x / (freedom + k * x);
  const double log_p = at < (a + 1.0) / (a + b + 2.0)
                           ? log_beta_ratio(a, b, at, rest)
                           : std::log1p(-std::min(std::exp(log_beta_ratio(b, a, rest, at)), 1.0));
  return std::min(0.0, log_p / std::numbers::ln10);
}

double chi_squared_point(double probability, double freedom) {
  const double log10_p = std::log10(probability);
  double low = 0.0;
  double high = 2.0 * freedom + 1500.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (log10_chi_squared_tail(middle, freedom) > log10_p ? low : high) = middle;
  }
  return low;
}

std::vector<double> adjust_by_holm(const std::vector<double>& log10_p) {
  std::vector<double> adjusted(log10_p.size());
  double largest = 0.0;
  std::size_t left = log10_p.size();
  for (const std::size_t i : ascending(log10_p)) {
    largest = std::max(largest, times(log10_p[i], static_cast<double>(left--)));
    adjusted[i] = largest;
  }
  return adjusted;
}

std::vector<double> adjust_by_benjamini_hochberg(const std::vector<double>& log10_p) {
  std::vector<double> adjusted(log10_p.size());
  std::vector<std::size_t> order = ascending(log10_p);
  const auto count = static_cast<double>(order.size());
  double smallest = 1.0;
  for (std::size_t rank = order.size(); rank > 0; --rank) {
    const std::size_t i = order[rank - 1];
    smallest = std::min(smallest, times(log10_p[i], count / static_cast<double>(rank)));
    adjusted[i] = smallest;
  }
  return adjusted;
}

}  // namespace sepcal::numerics
