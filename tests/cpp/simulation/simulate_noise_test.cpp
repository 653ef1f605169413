// SPDX-License-Identifier: BSD-3-Clause
// The kinds of noise by their statistics, and columns that drive nothing. Bounds are 4.5 standard
// errors: a good generator fails one with probability 7e-6.
#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

#include "calibrated_flights.hpp"
#include "numerics/decompositions.hpp"
#include "simulated_flights.hpp"
#include "simulation/simulated_noise.hpp"

namespace simulate_noise_test {

namespace {

using namespace sepcal;
using namespace sepcal::test;
using Eigen::ArrayXd;

constexpr std::size_t many = 40000;

/// The noise of the magnetometer's three axes, one after the other, over their standard deviation.
ArrayXd noise_of(NoiseKind kind, std::size_t rows, std::uint64_t seed = 0) {
  const MagnetometerTruth truth;
  SimulationOptions options = condensed(rows, seed);
  const SimulatedFlight clean = simulate_magnetometer(quiet(truth), options);
  options.noise = kind;
  const SimulatedFlight noisy = simulate_magnetometer(truth, options);
  ArrayXd all(3 * clean.rows());
  for (std::size_t j = 0; j < 3; ++j) {
    const auto n = static_cast<Eigen::Index>(rows);
    all.segment(static_cast<Eigen::Index>(j) * n, n) =
        (values(noisy, reading[j]) - values(clean, reading[j])) / truth.noise[j];
  }
  return all;
}

double lag_one(const ArrayXd& e) {
  return (e.tail(e.size() - 1) * e.head(e.size() - 1)).sum() / e.square().sum();
}

/// The slope of ln(power) over ln(frequency) from 1/256 to 1/5 cycles a row, by periodograms of
/// pieces of 1,024 rows.
double spectral_slope(const ArrayXd& e) {
  constexpr Eigen::Index piece = 1024;
  constexpr int frequencies = 20;
  Eigen::ArrayX2d logs(frequencies, 2);
  for (int f = 0; f < frequencies; ++f) {
    const double cycles = std::round(4 * std::pow(51.2, f / (frequencies - 1.0)));
    double power = 0;
    for (Eigen::Index begin = 0; begin + piece <= e.size(); begin += piece) {
      std::complex<double> sum = 0;
      for (Eigen::Index k = 0; k < piece; ++k) {
        const double turns = cycles * static_cast<double>(k) / static_cast<double>(piece);
        sum += e[begin + k] * std::polar(1.0, 2 * std::numbers::pi * turns);
      }
      power += std::norm(sum);
    }
    logs.row(f) << std::log(cycles), std::log(power);
  }
  const ArrayXd x = logs.col(0) - logs.col(0).mean();
  return (x * (logs.col(1) - logs.col(1).mean())).sum() / x.square().sum();
}

}  // namespace

TEST_CASE("autoregressive noise: correlation 0.9, the same standard deviation, white beneath") {
  const ArrayXd e = noise_of(NoiseKind::ar, many).head(many);
  const double n = static_cast<double>(e.size());
  CHECK(std::abs(e.square().mean() - 1) < 4.5 * std::sqrt(2 / n * (1 + 0.81) / (1 - 0.81)));
  CHECK(std::abs(lag_one(e) - 0.9) < 4.5 * std::sqrt((1 - 0.81) / n));
  const ArrayXd drawn = e.tail(e.size() - 1) - 0.9 * e.head(e.size() - 1);
  CHECK(std::abs(lag_one(drawn)) < 4.5 / std::sqrt(n));
}

TEST_CASE("pink noise has a spectrum of 1/f and the same standard deviation") {
  // The slopes' standard error is 0.02; the rest is the bank's ripple and the pieces' leakage.
  CHECK(std::abs(spectral_slope(noise_of(NoiseKind::pink, many)) + 1) < 0.12);
  CHECK(std::abs(spectral_slope(noise_of(NoiseKind::white, many))) < 0.1);
  // One value a record of 64 rows, 20,000 records: the mean square's error is sqrt(2/20,000).
  double sum = 0;
  constexpr int records = 20000;
  for (std::uint64_t seed = 0; seed < records; ++seed) {
    const double e = simulation::make_noise(NoiseKind::pink, 64, 1, seed)(40, 0);
    sum += e * e;
  }
  CHECK(std::abs(sum / records - 1) < 4.5 * std::sqrt(2.0 / records));
}

TEST_CASE("bursty noise: a tenth of the rows at four times the rest, the same mean square") {
  const ArrayXd all = noise_of(NoiseKind::bursty, many, 5);
  const double n = static_cast<double>(all.size());
  // E e^4 = 3 (0.9 q^4 + 0.1 (4 q)^4) with q^2 = 1/2.5; the mean square's error follows.
  const double fourth = 3 * (0.9 + 25.6) / 6.25;
  CHECK(std::abs(all.square().mean() - 1) < 4.5 * std::sqrt((fourth - 1) / n));
  // P(|e| > 3) = 0.1 P(|N| > 1.186) + 0.9 P(|N| > 4.74) = 0.02357.
  const double loud = static_cast<double>((all.abs() > 3).count()) / n;
  CHECK(std::abs(loud - 0.02357) < 4.5 * std::sqrt(0.02357 / n));
  // Beyond 4 standard deviations only in bursts (a quiet row: 3e-10), one in each fifth, a tenth of
  // it long, all axes at once.
  constexpr Eigen::Index rows = many, part = rows / 5;
  for (Eigen::Index fifth = 0; fifth < 5; ++fifth) {
    Eigen::Index first = rows, last = -1;
    for (Eigen::Index k = fifth * part; k < (fifth + 1) * part; ++k) {
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        if (std::abs(all[axis * rows + k]) < 4) continue;
        first = std::min(first, k);
        last = k;
      }
    }
    CHECK(last - first < part / 10);
    CHECK(last - first > part / 10 - 60);  // a row of a burst is beyond 4 with probability 0.3
  }
}

TEST_CASE("noise repeats with its seed, and its kinds differ") {
  using enum NoiseKind;
  for (const NoiseKind kind : {white, ar, pink, bursty}) {
    CHECK((noise_of(kind, 200, 4) == noise_of(kind, 200, 4)).all());
    CHECK((noise_of(kind, 200, 4) != noise_of(kind, 200, 5)).any());
    if (kind != white) CHECK((noise_of(kind, 200, 4) != noise_of(white, 200, 4)).any());
  }
  CHECK(find_noise_kind("pink") == pink);
  check_refused([] { find_noise_kind("brown"); }, {"'brown'", "white, ar, pink, bursty"});
}

TEST_CASE("the probes' outputs carry the kind of noise asked for") {
  SimulationOptions options{.seed = 2};
  options.noise = NoiseKind::ar;
  const SimulatedFlight five_hole = simulate_five_hole({}, options);
  const SimulatedFlight clean = simulate_five_hole(quiet(FiveHoleTruth{}));
  for (const char* name : velocity) {
    CHECK(lag_one(values(five_hole, name) - values(clean, name)) ==
          doctest::Approx(0.9).epsilon(0.02));
  }
  const SimulatedFlight tube = simulate_pitot_static({}, options);
  const SimulatedFlight quiet_tube = simulate_pitot_static(quiet(PitotStaticTruth{}));
  CHECK(lag_one(values(tube, "airspeed_mps") - values(quiet_tube, "airspeed_mps")) ==
        doctest::Approx(0.9).epsilon(0.02));
}

TEST_CASE("decoys drive nothing and are of five kinds in turn") {
  SimulationOptions options = condensed(2000, 6);
  const SimulatedFlight without = simulate_five_hole({}, options);
  options.decoys = 7;
  const SimulatedFlight with = simulate_five_hole({}, options);
  REQUIRE(with.columns.size() == without.columns.size() + 7);
  CHECK(with.columns.back().name == "decoy_7");
  for (const SimulatedColumn& column : without.columns) {
    CHECK(with.column(column.name) == column.values);
  }
  const auto decoy = [&](int k) { return values(with, ("decoy_" + std::to_string(k)).c_str()); };
  const auto change = [](const ArrayXd& d) -> ArrayXd {
    return d.tail(d.size() - 1) - d.head(d.size() - 1);
  };
  const double bound = 4.5 / std::sqrt(2000.0);
  CHECK(std::abs(lag_one(change(decoy(1)))) < bound);      // random walk
  CHECK(change(change(decoy(2))).abs().maxCoeff() < 0.1);  // smooth
  CHECK(decoy(2).abs().maxCoeff() > 1);
  CHECK(std::abs(lag_one(decoy(3)) - 0.9) < 4.5 * std::sqrt(0.19 / 2000));  // autoregressive
  CHECK(std::abs(lag_one(decoy(4))) < bound);                               // white
  const ArrayXd steps = decoy(5);
  const std::set<double> levels(steps.begin(), steps.end());
  CHECK(levels.size() > 1);
  CHECK(levels.size() < 30);  // ten in the mean
  CHECK((decoy(6) != decoy(1)).all());
  CHECK(std::abs(lag_one(change(decoy(6)))) < bound);

  CHECK(simulate_five_hole({}, options).column("decoy_3") == with.column("decoy_3"));
  options.seed = 7;
  CHECK(simulate_five_hole({}, options).column("decoy_3") != with.column("decoy_3"));
  for (const SimulatedFlight& flight :
       {simulate_magnetometer({}, options), simulate_pitot_static({}, options)}) {
    CHECK(flight.column("decoy_7").size() == 2000);
  }
  options.decoys = 1001;
  check_refused([&] { simulate_five_hole({}, options); }, {"1001", "at most 1000"});
}

}  // namespace simulate_noise_test
