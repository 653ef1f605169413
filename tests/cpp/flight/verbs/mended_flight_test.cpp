// SPDX-License-Identifier: BSD-3-Clause
// What stands in for rows that are no readings, and which rows are to be left out instead.
#include "flight/verbs/mended_flight.hpp"

#include "checked_logs.hpp"
#include "flight/aircraft/aircraft_columns.hpp"

namespace mended_flight_test {

using namespace sepcal;
using sepcal::test::blur;
using sepcal::test::pi;

namespace {

constexpr std::size_t rows = 1000;
const std::vector<std::size_t> coded{400, 401, 402, 650};

/// An inertial unit, an airspeed and a heading that turns once in the log and goes on from pi at
/// -pi; 50 Hz.
test::Log aircraft_log() {
  test::Log log;
  log.columns.emplace_back("time_s", std::vector<double>(rows));
  std::uint64_t seed = 0;
  for (const char* header : {"ax_mps2", "ay_mps2", "az_mps2", "p_radps", "q_radps", "r_radps",
                             "airspeed_mps", "yaw_rad"}) {
    std::vector<double>& values = log[header];
    for (std::size_t row = 0; row < rows; ++row) {
      values[row] = 1 + std::sin(2 * pi * 3 * static_cast<double>(row) / rows);
    }
    blur(values, 0.01, ++seed);
  }
  for (std::size_t row = 0; row < rows; ++row) {
    log["time_s"][row] = 0.02 * static_cast<double>(row);
    log["yaw_rad"][row] = std::remainder(2 * pi * (static_cast<double>(row) - 0.5) / rows, 2 * pi);
  }
  return log;
}

verbs::MendedFlight mend(AircraftModel model, const test::Log& log) {
  return verbs::mend(sepcal::aircraft_log::quantities_of(model), log.build(), {});
}

std::vector<double> mended(AircraftModel model, const test::Log& log, const char* header) {
  const verbs::MendedFlight mended = mend(model, log);
  const auto values = mended.flight.find(header)->values;
  return {values.begin(), values.end()};
}

}  // namespace

TEST_CASE("a model with a state takes the line over codes in what it is driven by and reads") {
  for (const char* header : {"q_radps", "az_mps2", "airspeed_mps", "yaw_rad"}) {
    test::Log log = aircraft_log();
    const std::vector<double> clean = log[header];
    for (const std::size_t row : coded) log[header][row] = -9999;
    const std::vector<double> path = mended(AircraftModel::path, log, header);
    for (const std::size_t row : coded) CHECK(std::abs(path[row] - clean[row]) < 0.06);
    CHECK(mend(AircraftModel::path, log).all.condition.empty());
    if (std::string(header) == "yaw_rad") continue;  // drives effects there
    CHECK(mended(AircraftModel::aero, log, header)[400] == -9999);
    CHECK(mend(AircraftModel::aero, log).all.condition == std::string(header) + " != -9999");
  }
}

TEST_CASE("no line is taken over the end of a turn") {
  test::Log log = aircraft_log();
  std::vector<double>& yaw = log["yaw_rad"];
  const double before = yaw[499];
  CHECK(before > 3);
  CHECK(yaw[502] < -3);
  for (const std::size_t row : {500U, 501U}) yaw[row] = 9999;
  const std::vector<double> path = mended(AircraftModel::path, log, "yaw_rad");
  CHECK(path[500] == before);
  CHECK(path[501] == before);
}

TEST_CASE("rows that stand still are left out, as no line tells what was there") {
  test::Log log = aircraft_log();
  std::fill_n(log["q_radps"].begin() + 300, 200, log["q_radps"][300]);
  for (const AircraftModel model : {AircraftModel::path, AircraftModel::aero}) {
    const verbs::MendedFlight found = mend(model, log);
    CHECK(found.all.columns == "q_radps");
    CHECK(found.all.condition == "not (6 <= time_s <= 9.98)");
  }
}

}  // namespace mended_flight_test
