// SPDX-License-Identifier: BSD-3-Clause
// Output error over a band: a short period that was integrated comes back, to rounding without
// noise and as often as its intervals say with it, biases, trim and open ends notwithstanding.
#include "sepcal/frequency/output_error_in_band.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "draws.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/short_period.hpp"
#include "sepcal/states/trajectory_model.hpp"

namespace output_error_in_band_test {

using doctest::Contains;
using sepcal::Error;
using sepcal::Fit;
using sepcal::Record;
using sepcal::ShortPeriod;

namespace {

const std::map<std::string, double> truth{
    {"Za", -1.5}, {"Ma", -8.0}, {"Mq", -2.0}, {"Zd", -0.2}, {"Md", -9.0}};

/// Fourth-order steps of a fifth of a row along straight lines between the rows' elevator, from a
/// start out of trim; readings with biases and white noise.
Record fly(double noise, unsigned seed) {
  constexpr double dt = 0.02;
  constexpr std::size_t rows = 1500;
  constexpr int parts = 5;
  sepcal::test::Draws draws(seed);
  std::map<std::string, std::vector<double>> columns;
  double x[2] = {0.03, -0.05};
  const auto elevator = [](double t) {
    return 0.03 * std::sin(1.1 * t + 0.05 * t * t) + 0.02 * std::sin(2.0 * t + 1.0) + 0.04;
  };
  const auto rate = [&](const double* at, double u, double* to) {
    to[0] = truth.at("Za") * at[0] + at[1] + truth.at("Zd") * u;
    to[1] = truth.at("Ma") * at[0] + truth.at("Mq") * at[1] + truth.at("Md") * u;
  };
  for (std::size_t row = 0; row < rows; ++row) {
    const double t = dt * static_cast<double>(row);
    const double u = elevator(t);
    columns["time"].push_back(t);
    columns["elevator"].push_back(u);
    columns["airspeed"].push_back(50.0);
    columns["alpha_m"].push_back(x[0] + 0.01 + 0.002 * noise * draws.normal());
    columns["q_m"].push_back(x[1] - 0.02 + 0.005 * noise * draws.normal());
    columns["az_m"].push_back(50.0 * (truth.at("Za") * x[0] + truth.at("Zd") * u) + 0.3 +
                              0.1 * noise * draws.normal());
    const double next = elevator(t + dt);
    for (int i = 0; i < parts; ++i) {
      const double h = dt / parts;
      const auto at = [&](double share) { return u + (next - u) * (i + share) / parts; };
      double k[4][2];
      double middle[2];
      rate(x, at(0.0), k[0]);
      for (int s = 1; s < 4; ++s) {
        const double ahead = s == 3 ? h : 0.5 * h;
        for (int j = 0; j < 2; ++j) middle[j] = x[j] + ahead * k[s - 1][j];
        rate(middle, at(s == 3 ? 1.0 : 0.5), k[s]);
      }
      for (int j = 0; j < 2; ++j) x[j] += h / 6.0 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
    }
  }
  Record record;
  for (auto& [name, values] : columns) record.add(name, std::move(values));
  return record;
}

Fit fit_in(const Record& record, const sepcal::Band& band) {
  const sepcal::TrajectoryModel<ShortPeriod> model(ShortPeriod{}, record);
  return sepcal::fit_output_error_in_band(
      model, record, band,
      {.start = {{"Za", -1.0}, {"Ma", -5.0}, {"Mq", -1.0}, {"Zd", 0.0}, {"Md", -6.0}}});
}

}  // namespace

TEST_CASE("without noise the truth comes back, whatever the biases and ends") {
  const Fit found = fit_in(fly(0.0, 1), {0.1, 2.0, 0.0});
  CHECK(found.status == sepcal::FitStatus::converged);
  CHECK(found.rows == 1500);
  for (const auto& [name, value] : truth) {
    CAPTURE(name);
    CHECK(found[name].value == doctest::Approx(value).epsilon(1e-4));
  }
}

TEST_CASE("with noise intervals hold as often as they say") {
  int inside = 0;
  int all = 0;
  double square = 0.0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const Fit found = fit_in(fly(1.0, seed), {0.1, 2.0, 0.0});
    REQUIRE(found.status == sepcal::FitStatus::converged);
    for (const auto& [name, value] : truth) {
      const double off = (found[name].value - value) / found[name].standard_error;
      square += off * off;
      inside += std::abs(off) < 1.96 ? 1 : 0;
      ++all;
    }
    for (const sepcal::OutputValue& noise : found.noise) {
      const double flown = noise.name == "q_m" ? 0.005 : noise.name == "az_m" ? 0.1 : 0.002;
      CHECK(noise.value == doctest::Approx(flown).epsilon(0.3));
    }
  }
  CHECK(inside > 0.91 * all);
  CHECK(inside < 0.985 * all);
  CHECK(std::sqrt(square / all) == doctest::Approx(1.0).epsilon(0.12));
}

TEST_CASE("what it can't do is refused") {
  const Record record = fly(0.0, 1);
  CHECK_THROWS_WITH_AS(fit_in(record, {0.1, 2.0, 0.05}), Contains("leave the spacing out"), Error);
  CHECK_THROWS_WITH_AS(fit_in(record, {2.0, 0.1, 0.0}), Contains("is none"), Error);
}

}  // namespace output_error_in_band_test
