// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/simulated_noise.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "sepcal/error.hpp"
#include "simulation/simulated_flight.hpp"

namespace sepcal::simulation {
namespace {

using Source = std::function<double()>;  // the next row's noise

/// First order, stationary from the start, variance 1; `correlation` from row to row.
Source make_autoregressive(RandomNumbers& random, double correlation) {
  return [&random, correlation, state = random.draw_normal()]() mutable {
    const double now = state;
    state = correlation * state + std::sqrt(1.0 - correlation * correlation) * random.draw_normal();
    return now;
  };
}

/// Equal parts of first-order processes whose time constants double: between the shortest and the
/// longest their spectra add up to 1/f.
Source make_pink(RandomNumbers& random, std::size_t rows) {
  std::vector<Source> octaves;
  for (std::size_t half_rows = 1; half_rows <= 2 * rows; half_rows *= 2) {
    const double correlation = std::exp(-2.0 / static_cast<double>(half_rows));
    octaves.push_back(make_autoregressive(random, correlation));
  }
  return [octaves = std::move(octaves)] {
    double sum = 0.0;
    for (const Source& octave : octaves) sum += octave();
    return sum / std::sqrt(static_cast<double>(octaves.size()));
  };
}

/// One burst at random in each fifth of the record, a tenth of it long.
std::vector<double> make_bursts(RandomNumbers& random, std::size_t rows) {
  constexpr std::size_t parts = 5;
  constexpr double strength = 4.0;
  const double quiet = 1.0 / std::sqrt(0.9 + 0.1 * strength * strength);
  std::vector<double> factors(rows, quiet);
  for (std::size_t part = 0; part < parts; ++part) {
    const std::size_t begin = rows * part / parts;
    const std::size_t length = rows * (part + 1) / parts - begin;
    const std::size_t burst = length / 10;
    const auto start =
        static_cast<std::size_t>(random.draw_uniform() * static_cast<double>(length - burst + 1));
    std::fill_n(factors.begin() + static_cast<std::ptrdiff_t>(begin + start), burst,
                strength * quiet);
  }
  return factors;
}

using Fill = void (*)(RandomNumbers&, const std::vector<double>& times, std::vector<double>& out);

void fill_random_walk(RandomNumbers& random, const std::vector<double>& times,
                      std::vector<double>& out) {
  const double stride = 1.0 / std::sqrt(static_cast<double>(times.size()));
  double sum = 0.0;
  for (double& value : out) value = sum += stride * random.draw_normal();
}

/// Three sinusoids, of periods between a fiftieth and a half of the record.
void fill_sinusoids(RandomNumbers& random, const std::vector<double>& times,
                    std::vector<double>& out) {
  const double length = times.back() - times.front();
  for (int k = 0; k < 3; ++k) {
    const double cycles = 2.0 * std::pow(25.0, random.draw_uniform());
    const double phase = 2.0 * pi * random.draw_uniform();
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double x = length > 0.0 ? (times[i] - times.front()) / length : 0.0;
      out[i] += std::sin(2.0 * pi * cycles * x + phase);
    }
  }
}

void fill_autoregressive(RandomNumbers& random, const std::vector<double>& /*times*/,
                         std::vector<double>& out) {
  std::ranges::generate(out, make_autoregressive(random, 0.9));
}

void fill_white(RandomNumbers& random, const std::vector<double>& /*times*/,
                std::vector<double>& out) {
  std::ranges::generate(out, [&random] { return random.draw_normal(); });
}

/// About ten levels, each held from a random row on.
void fill_steps(RandomNumbers& random, const std::vector<double>& times, std::vector<double>& out) {
  const double chance = 9.0 / static_cast<double>(times.size());
  double level = random.draw_normal();
  for (double& value : out) {
    if (random.draw_uniform() < chance) level = random.draw_normal();
    value = level;
  }
}

}  // namespace

double RandomNumbers::draw_uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

double RandomNumbers::draw_normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(1.0 - draw_uniform()));  // 1 - u: never log 0
  const double angle = 2.0 * pi * draw_uniform();
  spare_ = radius * std::sin(angle);
  has_spare_ = true;
  return radius * std::cos(angle);
}

Eigen::MatrixXd make_noise(NoiseKind kind, std::size_t rows, Eigen::Index outputs,
                           std::uint64_t seed) {
  RandomNumbers random(seed);
  std::vector<double> factors(rows, 1.0);
  if (kind == NoiseKind::bursty) factors = make_bursts(random, rows);
  std::vector<Source> sources;
  for (Eigen::Index j = 0; j < outputs; ++j) {
    if (kind == NoiseKind::ar) {
      sources.push_back(make_autoregressive(random, 0.9));
    } else if (kind == NoiseKind::pink) {
      sources.push_back(make_pink(random, rows));
    } else {
      sources.emplace_back([&random] { return random.draw_normal(); });
    }
  }
  Eigen::MatrixXd noise(static_cast<Eigen::Index>(rows), outputs);
  for (Eigen::Index row = 0; row < noise.rows(); ++row) {
    for (Eigen::Index j = 0; j < outputs; ++j) {
      const auto index = static_cast<std::size_t>(row);
      noise(row, j) = factors[index] * sources[static_cast<std::size_t>(j)]();
    }
  }
  return noise;
}

void add_decoys(SimulatedFlight& flight, const SimulationOptions& options) {
  constexpr std::size_t most = 1000;
  if (options.decoys > most) {
    throw Error("decoys: " + std::to_string(options.decoys) + " is too many; choose at most " +
                std::to_string(most));
  }
  constexpr Fill kinds[] = {fill_random_walk, fill_sinusoids, fill_autoregressive, fill_white,
                            fill_steps};
  constexpr std::uint64_t other_stream = 0x9E3779B97F4A7C15;  // decoys leave the noise as it is
  RandomNumbers random(options.seed ^ other_stream);
  const std::vector<double> times = flight.column("time_s");
  for (std::size_t k = 0; k < options.decoys; ++k) {
    std::vector<double> values(times.size(), 0.0);
    kinds[k % std::size(kinds)](random, times, values);
    flight.columns.push_back({"decoy_" + std::to_string(k + 1), std::move(values)});
  }
}

}  // namespace sepcal::simulation
