// SPDX-License-Identifier: BSD-3-Clause
// Inputs without their white noise: what is not noisy stays as it is, what is comes nearer to the
// truth, and angles that wrap are not torn.
#include "model/smooth_inputs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "draws.hpp"
#include "sepcal/detail/tables.hpp"

namespace smooth_inputs_test {

using namespace sepcal;
using sepcal::model::smooth;
using sepcal::test::Draws;

namespace {

std::vector<double> motion(std::size_t rows) {
  std::vector<double> x(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    const auto t = static_cast<double>(i);
    x[i] = 20.0 + 4.0 * std::sin(t / 60.0) + std::sin(t / 15.0);
  }
  return x;
}

double distance(const std::vector<double>& one, const std::vector<double>& other) {
  double square = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) square += std::pow(one[i] - other[i], 2);
  return std::sqrt(square / static_cast<double>(one.size()));
}

}  // namespace

TEST_CASE("motion without noise stays within the noise that it has not") {
  const std::vector<double> x = motion(800);
  CHECK(distance(smooth(x), x) < 1e-4);
}

TEST_CASE("white noise goes, motion stays") {
  Draws draws(3);
  const std::vector<double> truth = motion(800);
  std::vector<double> noisy = truth;
  for (double& value : noisy) value += 0.2 * draws.normal();
  CHECK(distance(noisy, truth) == doctest::Approx(0.2).epsilon(0.1));
  CHECK(distance(smooth(noisy), truth) < 0.08);
}

TEST_CASE("steps, held values, what is no number and few values are left alone") {
  std::vector<double> held = motion(400);
  for (std::size_t i = 0; i < held.size(); ++i) held[i] = held[i - i % 10];
  CHECK(smooth(held) == held);
  std::vector<double> broken = motion(400);
  broken[7] = std::nan("");
  CHECK(std::isnan(smooth(broken)[7]));
  CHECK(smooth(broken)[9] == broken[9]);
  const std::vector<double> few{1.0, 5.0, 2.0};
  CHECK(smooth(few) == few);
}

TEST_CASE("a record's inputs are smoothed by segment, and angles beyond pi") {
  Draws draws(4);
  Record record;
  std::vector<double> yaw(600);
  std::vector<double> truth(600);
  for (std::size_t i = 0; i < yaw.size(); ++i) {
    truth[i] = 0.03 * static_cast<double>(i);
    yaw[i] = std::remainder(truth[i] + 0.05 * draws.normal(), 2.0 * std::numbers::pi);
  }
  record.add("yaw", yaw).add("vn", motion(600));
  record.cut({{"", 0, 300}, {"", 300, 600}});
  const Tables tables{
      .inputs = {{"yaw", "rad"}, {"vn", "m/s"}}, .outputs = {}, .linear = {}, .nonlinear = {}};
  const Record smoothed = model::smooth_inputs(record, tables);
  double worst = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double off = std::remainder(smoothed.column("yaw")[i] - truth[i], 2.0 * std::numbers::pi);
    worst = std::max(worst, std::abs(off));
    CHECK(std::abs(smoothed.column("yaw")[i] - yaw[i]) < 0.5);  // the turn as it was logged
  }
  CHECK(worst < 0.08);
}

TEST_CASE("outputs and the time stay as they are") {
  Draws draws(5);
  std::vector<double> values = motion(400);
  for (double& value : values) value += 0.3 * draws.normal();
  Record record;
  record.add("time", values).add("vn", values).add("va", values);
  const Tables tables{.inputs = {{"time", "s"}, {"vn", "m/s"}, {"va", "m/s"}},
                      .outputs = {{"vn", "m/s"}},
                      .linear = {},
                      .nonlinear = {}};
  const Record smoothed = model::smooth_inputs(record, tables);
  CHECK(std::ranges::equal(smoothed.column("time"), values));
  CHECK(std::ranges::equal(smoothed.column("vn"), values));
  CHECK(!std::ranges::equal(smoothed.column("va"), values));
}

}  // namespace smooth_inputs_test
