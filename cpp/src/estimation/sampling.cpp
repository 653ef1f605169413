// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/sampling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "numerics/quantiles.hpp"
#include "sepcal/error.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Uniform within (0, 1), 53 bits; std::uniform_real_distribution differs between libraries.
double uniform(std::mt19937_64& generator) {
  return (static_cast<double>(generator() >> 11U) + 0.5) * 0x1p-53;
}

/// Digits of i in base p, mirrored at the point (van der Corput).
double mirrored_digits(std::uint64_t i, std::uint64_t p) {
  double result = 0.0;
  double place = 1.0;
  for (; i > 0; i /= p) {
    place /= static_cast<double>(p);
    result += place * static_cast<double>(i % p);
  }
  return result;
}

std::vector<std::uint64_t> first_primes(Index count) {
  std::vector<std::uint64_t> primes;
  for (std::uint64_t n = 2; static_cast<Index>(primes.size()) < count; ++n) {
    if (std::ranges::none_of(primes, [n](std::uint64_t p) { return n % p == 0; })) {
      primes.push_back(n);
    }
  }
  return primes;
}

/// S points of the unit cube (n x S).
MatrixXd unit_points(Index n, const FitOptions& options) {
  std::mt19937_64 generator(options.seed);
  MatrixXd points(n, options.samples);
  if (options.sampling == Sampling::uniform) {
    for (double& x : points.reshaped()) x = uniform(generator);
    return points;
  }
  const auto primes = first_primes(n);
  for (Index k = 0; k < n; ++k) {
    const double shift = uniform(generator);
    for (Index s = 0; s < points.cols(); ++s) {
      const double x = shift + mirrored_digits(static_cast<std::uint64_t>(s) + 1,
                                               primes[static_cast<std::size_t>(k)]);
      points(k, s) = x - std::floor(x);
    }
  }
  return points;
}

/// A quantile function on (0, 1) for one parameter.
std::function<double(double)> quantile_of(const Variable& parameter, const FitOptions& options) {
  const double lower = parameter.lower;
  const double upper = parameter.upper;
  const auto drawn = options.sampling_distribution.find(parameter.name);
  if (drawn != options.sampling_distribution.end()) {
    const auto [mean, sd] = drawn->second;
    if (lower > mean) {
      // In the upper tail probabilities crowd against one: draw the mirror image.
      FitOptions mirrored;
      mirrored.sampling_distribution[parameter.name] = {-mean, sd};
      const auto image = quantile_of({parameter.name, parameter.unit, -upper, -lower}, mirrored);
      return [image](double u) { return -image(1.0 - u); };
    }
    const double p_lower = numerics::normal_probability((lower - mean) / sd);
    const double p_upper = numerics::normal_probability((upper - mean) / sd);
    if (!(sd > 0) || !(p_upper > p_lower)) {
      throw Error("the sampling distribution of '" + parameter.name +
                  "' has no weight within its bounds; move it or widen the bounds");
    }
    return [=](double u) {
      const double p = std::clamp(p_lower + u * (p_upper - p_lower), 1e-300, 1.0 - 0x1p-53);
      return std::clamp(mean + sd * numerics::normal_quantile(p), lower, upper);
    };
  }
  if (!std::isfinite(lower) || !std::isfinite(upper)) {
    throw Error("nonlinear parameter '" + parameter.name +
                "' has no finite bounds to draw samples from; give it both, a start, or a normal "
                "sampling distribution");
  }
  return [=](double u) { return lower + u * (upper - lower); };
}

}  // namespace

MatrixXd draw_samples(const std::vector<Variable>& parameters, const FitOptions& options) {
  const auto n = static_cast<Index>(parameters.size());
  MatrixXd samples = unit_points(n, options);
  for (Index k = 0; k < n; ++k) {
    const auto quantile = quantile_of(parameters[static_cast<std::size_t>(k)], options);
    for (double& x : samples.row(k)) x = quantile(x);
  }
  return samples;
}

VectorXd nominal_point(const std::vector<Variable>& parameters, const FitOptions& options) {
  VectorXd point(static_cast<Index>(parameters.size()));
  for (Index k = 0; k < point.size(); ++k) {
    const Variable& parameter = parameters[static_cast<std::size_t>(k)];
    const auto drawn = options.sampling_distribution.find(parameter.name);
    const auto start = options.start.find(parameter.name);
    if (start != options.start.end()) {
      point[k] = std::clamp(start->second, parameter.lower, parameter.upper);
    } else if (drawn != options.sampling_distribution.end()) {
      point[k] = std::clamp(drawn->second.mean, parameter.lower, parameter.upper);
    } else if (std::isfinite(parameter.lower) && std::isfinite(parameter.upper)) {
      point[k] = 0.5 * (parameter.lower + parameter.upper);
    } else {
      point[k] = std::clamp(0.0, parameter.lower, parameter.upper);
    }
  }
  return point;
}

namespace {

/// Where it would begin.
void hold_idle(const BlockModel& model, const std::string& name, FitOptions& options) {
  double value = 0.0;
  for (auto* known : {&options.unsampled, &options.start}) {
    const auto at = known->find(name);
    if (at == known->end()) continue;
    value = at->second;
    known->erase(at);
  }
  for (const Variable& parameter : model.tables().parameters()) {
    if (parameter.name == name) value = std::clamp(value, parameter.lower, parameter.upper);
  }
  options.bounds.erase(name);
  options.fix.emplace(name, value);
}

}  // namespace

FitOptions with_starting_values(const BlockModel& model, const Record& record,
                                const std::string& segments, FitOptions options) {
  auto& known = options.start.empty() ? options.unsampled : options.start;
  for (const auto& [name, value] : model.starting_values(record)) {
    const bool said = options.fix.contains(name) || options.sampling_distribution.contains(name);
    if (!said) known.emplace(name, value);
  }
  if (!segments.empty()) {
    for (const std::string& name : model.idle_parameters(record.select(segments))) {
      if (!options.prior.contains(name)) hold_idle(model, name, options);
    }
  }
  const std::vector<Variable> all = model.tables().parameters();
  const bool nothing_to_sample = std::ranges::all_of(all, [&](const Variable& parameter) {
    return options.fix.contains(parameter.name) || options.unsampled.contains(parameter.name);
  });
  if (nothing_to_sample) options.start.merge(options.unsampled);
  return options;
}

}  // namespace sepcal::estimation
