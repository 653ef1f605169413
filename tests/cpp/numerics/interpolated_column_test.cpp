// SPDX-License-Identifier: BSD-3-Clause
// Columns between their rows: within a segment, over the jumps of an angle.
#include "numerics/interpolated_column.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "composed_models.hpp"
#include "sepcal/error.hpp"

namespace interpolated_column_test {

using doctest::Approx;
using doctest::Contains;
using sepcal::NaturalSpline;
using sepcal::Record;
using sepcal::numerics::InterpolatedColumn;

namespace {

std::vector<NaturalSpline::Value> read(const InterpolatedColumn& column, std::size_t first,
                                       std::size_t rows, double shift) {
  std::vector<NaturalSpline::Value> values(rows);
  column.fill(first, shift, values);
  return values;
}

}  // namespace

TEST_CASE("without a shift the values are the column's, with one those of the signal then") {
  const std::vector<double> time = sepcal::test::uneven_times(400, 0.05);
  const Record record = sepcal::test::sample({{"x", [](double t) { return std::sin(t); }}}, time);
  const InterpolatedColumn column(record, "x");
  const auto here = read(column, 0, 400, 0.0);
  for (std::size_t k = 0; k < 400; ++k) CHECK(here[k].value == Approx(std::sin(time[k])));
  for (const double shift : {-0.31, 0.02, 0.27}) {
    const auto there = read(column, 50, 300, shift);
    for (std::size_t k = 0; k < 300; ++k) {
      const double t = time[50 + k] + shift;
      CHECK(std::abs(there[k].value - std::sin(t)) < 1e-6);  // (5/384) 0.06^4, ends a little more
      CHECK(std::abs(there[k].slope - std::cos(t)) < 1e-4);
      CHECK(std::abs(there[k].curvature + std::sin(t)) < 1e-2);
    }
  }
}

TEST_CASE("it does not matter from when on time is counted") {
  std::vector<double> time;
  for (int k = 0; k < 200; ++k) time.push_back(k / 64.0);
  const auto sine = [](double t) { return std::sin(t); };
  const Record early = sepcal::test::sample({{"x", sine}}, time);
  for (double& t : time) t += 1.7e9;  // exact
  const Record late =
      sepcal::test::sample({{"x", [&](double t) { return sine(t - 1.7e9); }}}, time);
  const auto expected = read(InterpolatedColumn(early, "x"), 20, 100, 0.0123);
  const auto values = read(InterpolatedColumn(late, "x"), 20, 100, 0.0123);
  for (std::size_t k = 0; k < 100; ++k) {
    CHECK(values[k].value == expected[k].value);
    CHECK(values[k].slope == expected[k].slope);
  }
}

TEST_CASE("no value of another segment has a share, however near it is") {
  // A jump of 1000 at row 20. Each side is a straight line, and stays one past the edge.
  Record record;
  std::vector<double> time;
  std::vector<double> x;
  for (int k = 0; k < 40; ++k) {
    time.push_back(k);
    x.push_back(k < 20 ? 2.0 * k : 1000.0 - k);
  }
  record.add("time", time).add("x", x);
  record.cut({{"a", 0, 20}, {"b", 20, 40}});
  const InterpolatedColumn column(record, "x");
  for (const double shift : {-7.5, -0.5, 0.0, 0.5, 7.5}) {
    CAPTURE(shift);
    for (std::size_t first : {0U, 13U}) {
      const auto values = read(column, first, 20 - first, shift);
      for (std::size_t k = 0; k < values.size(); ++k) {
        CHECK(values[k].value == Approx(2.0 * (static_cast<double>(first + k) + shift)));
      }
    }
    const auto values = read(column, 20, 20, shift);
    for (std::size_t k = 0; k < values.size(); ++k) {
      CHECK(values[k].value == Approx(1000.0 - (static_cast<double>(20 + k) + shift)));
    }
  }
}

TEST_CASE("an angle is taken without its jumps of a whole turn, any other column as it stands") {
  const std::vector<double> time = sepcal::test::uneven_times(200, 0.1);
  const auto wrapped = [](double t) { return std::remainder(1.3 * t, 2 * std::numbers::pi); };
  const Record record = sepcal::test::sample({{"yaw", wrapped}}, time);
  const InterpolatedColumn angle(record, "yaw", true);
  for (const auto& value : read(angle, 10, 180, 0.043)) CHECK(value.slope == Approx(1.3));
  const auto values = read(angle, 10, 180, 0.043);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double turned = 1.3 * (time[10 + k] + 0.043);
    CHECK(std::abs(std::remainder(values[k].value - turned, 2 * std::numbers::pi)) < 1e-12);
  }
  const InterpolatedColumn plain(record, "yaw");
  double steepest = 0;
  for (const auto& value : read(plain, 10, 180, 0.043)) {
    steepest = std::max(steepest, std::abs(value.slope));
  }
  CHECK(steepest > 10.0);
}

TEST_CASE("white noise is as large between rows as on them, and the signal moves") {
  // 0.3 of noise on a sine of 5 over 60 s; a natural spline through the samples has 0.57 of their
  // variance midway. Four standard deviations of a mean of 2,000 squares are 13 %.
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, 0.3);
  const auto sine = [](double t) { return 5.0 * std::sin(0.105 * t); };
  std::vector<double> time;
  std::vector<double> noisy;
  for (int k = 0; k < 2000; ++k) {
    time.push_back(0.1 * k);
    noisy.push_back(sine(time.back()) + noise(random));
  }
  Record record;
  record.add("time", time).add("x", noisy);
  const InterpolatedColumn column(record, "x");
  for (const double shift : {0.0, 0.02, 0.05, 0.1, 0.25}) {
    CAPTURE(shift);
    double squares = 0.0;
    double of_slope = 0.0;
    const auto values = read(column, 0, 2000, shift);
    for (std::size_t k = 50; k < 1950; ++k) {
      squares += std::pow(values[k].value - sine(time[k] + shift), 2) / 1900;
      of_slope += std::pow(values[k].slope - 5 * 0.105 * std::cos(0.105 * time[k]), 2) / 1900;
    }
    CHECK(std::abs(squares / 0.09 - 1.0) < 0.13);
    CHECK(std::sqrt(of_slope) < 0.1);  // of 0.53; that of a spline through the samples is 7
  }
  CHECK(read(column, 700, 1, 0.0)[0].value == Approx(noisy[700]));
}

TEST_CASE("rows outside the segments have no value, a segment of one row is an error") {
  Record record;
  record.add("time", {0, 1, 2, 3, 4, 5}).add("x", {0, 1, 2, 3, 4, 5});
  record.cut({{"a", 1, 3}, {"b", 4, 6}});
  const InterpolatedColumn column(record, "x");
  CHECK(read(column, 4, 2, 0.5)[0].value == Approx(4.5));
  for (const std::size_t row : {0U, 3U, 6U}) {
    CHECK_THROWS_WITH_AS(read(column, row, 1, 0.0), Contains("is in no segment"), sepcal::Error);
  }
  record.cut({{"a", 1, 3}, {"lone", 4, 5}});
  const auto lone = read(InterpolatedColumn(record, "x"), 4, 1, 0.3);
  CHECK(lone[0].value == 4);
  CHECK(lone[0].slope == 0);
}

}  // namespace interpolated_column_test
