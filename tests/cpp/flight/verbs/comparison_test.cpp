// SPDX-License-Identifier: BSD-3-Clause
// Residuals made by hand, put on top of an exact flight: every number follows on paper.
#include "sepcal/flight/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "flights_with_effects.hpp"

namespace comparison_test {

using namespace sepcal;
using namespace sepcal::test;
using Values = std::vector<double>;

namespace {

/// Twenty rows, 1 s apart, that the truth explains but for `residual` in vn.
SimulatedFlight make_flight_with(const Values& residual, const std::vector<std::string>& labels) {
  SimulatedFlight flight = simulate_five_hole(quiet(FiveHoleTruth{}), condensed(residual.size()));
  for (SimulatedColumn& column : flight.columns) {
    for (std::size_t row = 0; row < residual.size(); ++row) {
      if (column.name == "time_s") column.values[row] = static_cast<double>(row);
      if (column.name == "vn_mps") column.values[row] += residual[row];
    }
  }
  flight.maneuver = labels;
  return flight;
}

Calibration make_truth() { return make_calibration(make_five_hole(), FiveHoleTruth{}.parameters); }

Comparison compare_with(const Values& residual, const std::vector<std::string>& labels) {
  return compare(make_truth(), make_flight(make_flight_with(residual, labels)));
}

std::vector<std::string> name_rows(std::size_t first, const std::string& one, std::size_t second,
                                   const std::string& other) {
  std::vector<std::string> labels(first, one);
  labels.insert(labels.end(), second, other);
  return labels;
}

void check_misfit(const Misfit& misfit, const std::string& segment, std::size_t rows, double rmse,
                  double mean, double lag_one) {
  CHECK(misfit.segment == segment);
  CHECK(misfit.rows == rows);
  CHECK(misfit.rmse == doctest::Approx(rmse).epsilon(1e-10));
  CHECK(std::abs(misfit.mean - mean) < 1e-10);
  CHECK(std::abs(misfit.lag_one - lag_one) < 1e-10);
}

const Values waves{1, -1, 1, -1, 1, -1, 1,  -1, 1,  -1,   // products of neighbours: nine of -1
                   2, 2,  2, 2,  2, -2, -2, -2, -2, -2};  // eight of 4 and one of -4

}  // namespace

TEST_CASE("each maneuver by itself, all of them together, never across an edge") {
  const Comparison result = compare_with(waves, name_rows(10, "climb", 10, "turn"));
  REQUIRE(result.where.size() == 6);
  check_misfit(result.where[0], "climb", 10, 1.0, 0.0, -9.0 / 10);
  check_misfit(result.where[3], "turn", 10, 2.0, 0.0, 28.0 / 40);
  // Across the edge there would be -1 * 2 more in the sum of products.
  check_misfit(result.overall[0], "", 20, std::sqrt(50.0 / 20), 0.0, (-9.0 + 28.0) / 50);
  CHECK(result.where[0].output == "vn");
  CHECK(result.where[0].unit == "m/s");
  CHECK(result.where[4].output == "ve");
  CHECK(result.where[5].rmse < 1e-10);
  CHECK(result.residuals.rows() == 20);
  CHECK(result.residuals.cols() == 3);
  for (std::size_t row = 0; row < 20; ++row) {
    CHECK(std::abs(result.residuals(static_cast<Eigen::Index>(row), 0) - waves[row]) < 1e-10);
    CHECK(result.time[row] == static_cast<double>(row));
  }
}

TEST_CASE("a residual has the sign of measured minus modelled, and a lag about its mean") {
  Values offset = waves;
  for (double& value : offset) value += 3.0;
  const Comparison result = compare_with(offset, name_rows(10, "climb", 10, "turn"));
  check_misfit(result.where[0], "climb", 10, std::sqrt(10.0), 3.0, -9.0 / 10);
  check_misfit(result.where[3], "turn", 10, std::sqrt(13.0), 3.0, 28.0 / 40);
}

TEST_CASE("runs of one label are taken together, in order of first appearance") {
  std::vector<std::string> labels = name_rows(5, "turn", 5, "climb");
  labels.insert(labels.end(), 10, "turn");
  const Comparison result = compare_with(waves, labels);
  REQUIRE(result.where.size() == 6);
  // Rows 0-4 are 1 -1 1 -1 1: with the rest a mean of 1 / 15, four products, none over the gap.
  const double mean = 1.0 / 15;
  double products = 0;
  for (std::size_t row = 0; row < 19; ++row) {
    if (row < 4 || row >= 10) products += (waves[row] - mean) * (waves[row + 1] - mean);
  }
  check_misfit(result.where[0], "turn", 15, std::sqrt(45.0 / 15), mean,
               products / (45.0 - 15 * mean * mean));
  // Rows 5-9 are -1 1 -1 1 -1: about the mean, three of -0.8 and two of 1.2.
  check_misfit(result.where[3], "climb", 5, 1.0, -1.0 / 5, -3.84 / 4.8);
}

TEST_CASE("a gap in time is an edge as well") {
  SimulatedFlight flight = make_flight_with(waves, name_rows(10, "climb", 10, "climb"));
  for (std::size_t row = 10; row < 20; ++row) flight.columns[0].values[row] += 50.0;
  const Comparison result = compare(make_truth(), make_flight(flight));
  check_misfit(result.overall[0], "", 20, std::sqrt(50.0 / 20), 0.0, (-9.0 + 28.0) / 50);
}

TEST_CASE("without two labels there are ten spans of equal length") {
  const Comparison result = compare_with(waves, name_rows(20, "flight", 0, ""));
  REQUIRE(result.where.size() == 30);
  for (std::size_t span = 0; span < 10; ++span) {
    const Misfit& misfit = result.where[3 * span];
    const std::size_t first = 2 * span;
    CHECK(misfit.segment == std::to_string(first) + ":" + std::to_string(first + 1));
    CHECK(misfit.rows == 2);
    CHECK(std::abs(misfit.mean - (waves[first] + waves[first + 1]) / 2) < 1e-10);
    CHECK(std::isnan(misfit.lag_one));  // of two rows none is defined
  }
}

TEST_CASE("the JSON has the numbers, and null where there is none") {
  const Comparison result = compare_with(waves, name_rows(18, "climb", 2, "turn"));
  const auto root = nlohmann::json::parse(to_json(result));
  CHECK(root["model"] == "five-hole");
  CHECK(root["status"] == "converged");
  CHECK(root["inputs"]["rows_used"] == 20);
  CHECK(root["rmse"]["vn"].get<double>() == result.overall[0].rmse);
  CHECK(root["residual"]["vn"]["lag_one"].get<double>() == result.overall[0].lag_one);
  REQUIRE(root["where"].size() == 6);
  CHECK(root["where"][3]["segment"] == "turn");
  CHECK(root["where"][3]["output"] == "vn");
  CHECK(root["where"][3]["rows"] == 2);
  CHECK(root["where"][3]["mean"].get<double>() == doctest::Approx(-2.0));
  CHECK(root["where"][3]["lag_one"].is_null());
}

TEST_CASE("status and message of the calibration are repeated, bad flights refused") {
  Calibration calibration = make_truth();
  calibration.fit.status = FitStatus::not_identifiable;
  calibration.fit.message = "w_n and b_va can't be told apart";
  SimulatedFlight flight = make_flight_with(waves, name_rows(20, "turn", 0, ""));
  const Comparison result = compare(calibration, make_flight(flight));
  CHECK(result.status == FitStatus::not_identifiable);
  CHECK(result.message == calibration.fit.message);
  flight.columns[0].values[7] = 6.0;
  check_refused([&] { compare(calibration, make_flight(flight)); },
                {"flight row 7", "repeats", "must increase"});
}

TEST_CASE("an effect means the same on another flight: its centre, knots and span stay") {
  // The other flight is 200 m higher. The simulator takes the altitude about that flight's own
  // mean, so that the rise goes into the wind.
  constexpr double noise = 1e-3;
  const SizedEffect shear{"wind[altitude_m]", {0.02, -0.03}};
  const SimulatedFlight first = fly("five-hole", {shear}, {.noise = 1e-6, .seed = 1});
  const Calibration calibration = calibrate_with("five-hole", first, {"wind[altitude_m]"});
  const double centre = values(first, "altitude_m").mean();
  CHECK(calibration.options.effects[0].centre.value() == doctest::Approx(centre).epsilon(1e-12));

  FiveHoleTruth higher =
      truth_of<FiveHoleTruth>({shear}, {.noise = noise, .seed = 1, .altitude = 500.0});
  const SimulatedFlight other = simulate_five_hole(higher, condensed(400, 9));
  const double rise = values(other, "altitude_m").mean() - centre;
  REQUIRE(rise > 150.0);
  higher.parameters["w_n"] += 0.02 * rise;
  higher.parameters["w_e"] -= 0.03 * rise;
  const Flight flight = make_flight(simulate_five_hole(higher, condensed(400, 9)));
  for (const Misfit& misfit : compare(calibration, flight).overall) {
    CHECK(std::abs(misfit.rmse / noise - 1.0) < 0.2);
  }
  Calibration forgetful = calibration;
  forgetful.options.effects = {{.name = "wind[altitude_m]"}};
  CHECK(compare(forgetful, flight).overall[0].rmse > 100.0 * noise);
}

TEST_CASE("a flight without an effect's channel is refused, one in which it is constant is not") {
  const SizedEffect bias{"airspeed_bias[flap]", {0.7}};
  SimulatedFlight flight = fly("five-hole", {bias});
  const Calibration calibration = calibrate_with("five-hole", flight, {bias.name});
  SimulatedFlight level = fly("five-hole", {});
  const auto flap = std::ranges::find(level.columns, "flap", &SimulatedColumn::name);
  std::ranges::fill(flap->values, 0.0);
  for (const Misfit& misfit : compare(calibration, make_flight(level)).overall) {
    CHECK(misfit.rmse < 1e-6);
  }
  level.columns.erase(flap);
  check_refused([&] { compare(calibration, make_flight(level)); },
                {"flight: effect airspeed_bias[flap]: there is no channel 'flap'"});
}

}  // namespace comparison_test
