// SPDX-License-Identifier: BSD-3-Clause
// The rows between the samples of slow columns: held, interpolated, several at once.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "flight_log.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"
#include "sepcal/error.hpp"

namespace log_choice_test {

using sepcal::Error;
using sepcal::prepare_pitot_static;
using sepcal::ProbeRecord;
using sepcal::test::Log;

namespace {

constexpr std::size_t rows = 400;
constexpr std::size_t slow = 8;

/// A sensor's noisy answers at every row.
std::vector<double> noisy(double mean, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> noise;
  std::vector<double> values(rows);
  for (double& value : values) value = mean + noise(generator);
  return values;
}

/// The answer of every eighth row, held for the seven behind it.
std::vector<double> held(std::vector<double> values) {
  for (std::size_t i = 0; i < rows; ++i) values[i] = values[i / slow * slow];
  return values;
}

/// Straight lines from every eighth row to the next.
std::vector<double> interpolated(std::vector<double> values) {
  for (std::size_t i = 0; i + slow < rows; ++i) {
    const std::size_t knot = i / slow * slow;
    const double share = static_cast<double>(i - knot) / slow;
    values[i] += (1 - share) * values[knot] + share * values[knot + slow] - values[i];
  }
  return values;
}

Log make_log() {
  Log log;
  std::vector<double> time(rows);
  for (std::size_t i = 0; i < rows; ++i) time[i] = 0.02 * static_cast<double>(i);
  log.columns = {{"time_s", time},
                 {"vn_mps", noisy(30, 1)},
                 {"ve_mps", noisy(-5, 2)},
                 {"vd_mps", noisy(1, 3)},
                 {"airspeed_kt", noisy(60, 4)}};
  return log;
}

ProbeRecord prepare(const Log& log, std::vector<std::string> slow_columns) {
  return prepare_pitot_static(log.build(), {.drop_repeats = std::move(slow_columns)});
}

}  // namespace

TEST_CASE("of held rows the first counts") {
  Log log = make_log();
  log["airspeed_kt"] = held(log["airspeed_kt"]);
  for (const char* name : {"airspeed", "airspeed_kt"}) {
    const ProbeRecord prepared = prepare(log, {name});
    REQUIRE(prepared.rows_used() == rows / slow);
    for (std::size_t i = 0; i < rows / slow; ++i) CHECK(prepared.flight_rows[i] == slow * i);
    CHECK(prepared.dropped.front().rows == rows - rows / slow);
    CHECK(prepared.notes.front() == std::string("log: 350 of 400 rows were dropped: they lie "
                                                "between samples of ") +
                                        name);
  }
}

TEST_CASE("of interpolated rows those count at which the lines bend") {
  Log log = make_log();
  log["airspeed_kt"] = interpolated(log["airspeed_kt"]);
  const ProbeRecord prepared = prepare(log, {"airspeed"});
  CHECK(prepared.rows_used() > rows / slow - 3);
  for (const std::size_t row : prepared.flight_rows) {
    CHECK((row % slow == 0 || row > rows - slow));  // the last answers are as they were
  }
}

TEST_CASE("a row counts in which any of several columns was sampled") {
  Log log = make_log();
  std::vector<double> late(rows);
  const std::vector<double> answers = log["vn_mps"];
  for (std::size_t i = 0; i < rows; ++i) late[i] = answers[(i + slow / 2) / slow * slow % rows];
  log["vn_mps"] = late;
  log["airspeed_kt"] = held(log["airspeed_kt"]);
  CHECK(prepare(log, {"airspeed", "vn"}).rows_used() ==
        doctest::Approx(2 * rows / slow).epsilon(0.02));
}

TEST_CASE("a fast column loses nothing") {
  CHECK(prepare(make_log(), {"airspeed"}).rows_used() == rows);
}

TEST_CASE("a row that is dropped need not be good") {
  Log log = make_log();
  log["airspeed_kt"] = held(log["airspeed_kt"]);
  log["vn_mps"][3] = sepcal::not_a_number;
  CHECK_THROWS_AS(prepare_pitot_static(log.build()), Error);
  CHECK(prepare(log, {"airspeed"}).rows_used() == rows / slow);
}

TEST_CASE("a column that is not there is refused by name") {
  CHECK_THROWS_WITH_AS(
      prepare(make_log(), {"groundspeed"}),
      "log: drop_repeats names groundspeed, which is no column; the flight has: time_s, vn_mps, "
      "ve_mps, vd_mps, airspeed_kt",
      Error);
}

}  // namespace log_choice_test
