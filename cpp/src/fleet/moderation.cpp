// SPDX-License-Identifier: BSD-3-Clause
#include "fleet/moderation.hpp"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>

#include "sepcal/detail/tables.hpp"

namespace sepcal::fleet {
namespace {

double digamma(double x) { return Eigen::numext::digamma(x); }
double trigamma(double x) { return Eigen::numext::polygamma(1.0, x); }
double tetragamma(double x) { return Eigen::numext::polygamma(2.0, x); }

/// x of trigamma(x) = y > 0 by Newton's method on its reciprocal, which is convex (Smyth 2004,
/// Appendix).
double inverse_trigamma(double y) {
  double x = 0.5 + 1.0 / y;
  for (int step = 0; step < 50; ++step) {
    const double at = trigamma(x);
    const double change = at * (1.0 - at / y) / tetragamma(x);
    x += change;
    if (-change < 1e-8 * x) break;
  }
  return x;
}

}  // namespace

Moderation moderate(const std::vector<double>& inflations, const std::vector<double>& freedoms) {
  Moderation moderation;
  std::vector<double> logarithms;  // of s_v^2, less what their own chance adds
  double by_chance = 0.0;          // mean variance of that
  double weight = 0.0;
  double sum = 0.0;
  for (std::size_t v = 0; v < inflations.size(); ++v) {
    const double half = 0.5 * freedoms[v];
    if (!(half > 0.0) || !(inflations[v] > 0.0)) continue;
    logarithms.push_back(std::log(inflations[v]) - digamma(half) + std::log(half));
    by_chance += trigamma(half);
    weight += freedoms[v];
    sum += freedoms[v] * inflations[v];
  }
  double prior_freedom = infinity;
  double prior = 1.0;
  moderation.is_known = weight > 0.0;
  if (moderation.is_known) {
    moderation.pooled = sum / weight;
    prior = moderation.pooled;
  }
  const auto n = static_cast<double>(logarithms.size());
  if (n > 2.0) {
    double mean = 0.0;
    for (const double e : logarithms) mean += e / n;
    double variance = -by_chance / n;
    for (const double e : logarithms) variance += (e - mean) * (e - mean) / (n - 1.0);
    if (variance > 0.0) {
      const double half = inverse_trigamma(variance);
      prior_freedom = 2.0 * half;
      prior = std::exp(mean + digamma(half) - std::log(half));
    }
  }
  for (std::size_t v = 0; v < inflations.size(); ++v) {
    const double own = freedoms[v];
    const double moderated =
        std::isinf(prior_freedom)
            ? prior
            : (prior_freedom * prior + own * inflations[v]) / (prior_freedom + own);
    moderation.inflations.push_back(std::max(1.0, moderated));
    moderation.freedoms.push_back(prior_freedom + own);
  }
  return moderation;
}

}  // namespace sepcal::fleet
