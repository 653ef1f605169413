// SPDX-License-Identifier: BSD-3-Clause
// Residuals against channels and by window, put on top of an exact flight by hand.
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "calibrated_flights.hpp"
#include "sepcal/flight/comparison.hpp"
#include "simulated_records.hpp"

namespace comparison_channels_test {

using namespace sepcal;
using namespace sepcal::test;
using doctest::Approx;

namespace {

constexpr std::size_t rows = 400;

double at(std::size_t row) { return static_cast<double>(row) / rows; }

/// A flight that the truth explains but for `error(row)` in vn, with channels to blame.
Comparison compare_with(const std::function<double(std::size_t)>& error) {
  SimulatedFlight simulated = simulate_five_hole(quiet(FiveHoleTruth{}), condensed(rows));
  for (SimulatedColumn& column : simulated.columns) {
    if (column.name != "vn_mps") continue;
    for (std::size_t row = 0; row < rows; ++row) column.values[row] += error(row);
  }
  Flight flight = make_flight(simulated);
  std::vector<double> current(rows);
  std::vector<double> gear(rows, 0.3);
  std::vector<double> hum(rows);
  std::vector<double> torn(rows, 1.0);
  for (std::size_t row = 0; row < rows; ++row) {
    current[row] = std::sin(0.1 * static_cast<double>(row)) + 5.0;
    hum[row] = row % 2 == 0 ? 1.0 : -1.0;
  }
  torn[7] = std::nan("");
  flight.add("load_a", current).add("gear", gear).add("hum", hum).add("torn", torn);
  Calibration calibration = make_calibration(make_five_hole(), FiveHoleTruth{}.parameters);
  calibration.fit.noise = {{"vn", 1.0}, {"ve", 1.0}, {"vd", 1.0}};
  return compare(calibration, flight);
}

const ChannelMisfit& find(const Comparison& comparison, const std::string& driver) {
  for (const ChannelMisfit& channel : comparison.channels) {
    if (channel.driver == driver && channel.output == "vn") return channel;
  }
  FAIL("no channel " << driver);
  return comparison.channels.front();
}

}  // namespace

TEST_CASE("a line of a channel is explained whole, with its slope and unit, and comes first") {
  const Comparison result = compare_with(
      [](std::size_t row) { return 0.2 * std::sin(0.1 * static_cast<double>(row)) + 0.7; });
  const ChannelMisfit& channel = result.channels.front();
  CHECK(channel.driver == "load_a");
  CHECK(channel.output == "vn");
  CHECK(channel.share_line == Approx(1.0).epsilon(1e-9));
  CHECK(channel.share_smooth == Approx(1.0).epsilon(1e-9));
  CHECK(channel.slope == Approx(0.2).epsilon(1e-9));
  CHECK(channel.unit == "m/s per A");
  CHECK(find(result, "alpha").unit == "m/s per rad");
  CHECK(find(result, "pt").unit == "m/s per Pa");
  CHECK(find(result, "time").unit == "m/s per s");
  std::set<std::string> drivers;
  for (std::size_t k = 0; k < result.channels.size(); ++k) {
    drivers.insert(result.channels[k].driver);
    CHECK(result.channels[k].share_line <= result.channels[k].share_smooth);
    if (k > 0) CHECK(result.channels[k].share_smooth <= result.channels[k - 1].share_smooth);
  }
  for (const char* absent : {"vn", "ve", "vd", "gear", "torn", "maneuver"}) {
    CHECK_FALSE(drivers.contains(absent));
  }
  CHECK(drivers.contains("hum"));
}

TEST_CASE("what bends is seen by the smooth curve alone") {
  const Comparison result =
      compare_with([](std::size_t row) { return std::cos(2.0 * std::acos(-1.0) * at(row)); });
  // A cosine over its whole period is even about the middle: no line, and six knots follow it.
  const ChannelMisfit& time = find(result, "time");
  CHECK(time.share_line < 1e-3);
  CHECK(time.share_smooth > 0.98);
  CHECK(find(result, "hum").share_smooth < 1e-3);
}

TEST_CASE("the slope's error is the textbook's on white noise, and larger on noise that is slow") {
  Draws draws(7);
  std::vector<double> white(rows);
  for (double& value : white) value = draws.normal();
  std::vector<double> slow = white;
  for (std::size_t row = 1; row < rows; ++row) slow[row] += 0.95 * slow[row - 1];
  const auto error_over_textbook = [](const std::vector<double>& noise) {
    const Comparison result = compare_with([&](std::size_t row) { return noise[row]; });
    const double n = rows;
    const double spread = std::sqrt((n * n - 1.0) / 12.0) * (result.time[1] - result.time[0]);
    const double deviation =
        std::sqrt(std::pow(result.overall[0].rmse, 2) - std::pow(result.overall[0].mean, 2));
    return find(result, "time").slope_error / (deviation / std::sqrt(n) / spread);
  };
  CHECK(error_over_textbook(white) == Approx(1.0).epsilon(0.02));
  CHECK(error_over_textbook(slow) > 3.0);
}

TEST_CASE("the worst windows: five of twenty, worst first, in units of noise") {
  // Window i of twenty holds rows 20 i to 20 i + 19.
  const std::map<std::size_t, double> errors{{3, 0.5}, {4, -2.0}, {9, 1.0}, {15, 3.0}, {19, 0.2}};
  const Comparison result = compare_with([&](std::size_t row) {
    const auto found = errors.find(row / 20);
    return found == errors.end() ? 0.0 : found->second;
  });
  REQUIRE(result.windows.size() == 5);
  const std::vector<std::size_t> order{15, 4, 9, 3, 19};
  for (std::size_t k = 0; k < 5; ++k) {
    const Window& window = result.windows[k];
    const double error = errors.at(order[k]);
    CHECK(window.rows == 20);
    CHECK(window.first_s == result.time[20 * order[k]]);
    CHECK(window.last_s == result.time[20 * order[k] + 19]);
    REQUIRE(window.rmse.size() == 3);
    CHECK(window.rmse[0].name == "vn");
    CHECK(window.rmse[0].value == Approx(std::abs(error)));
    CHECK(window.mean[0].value == Approx(error));
    CHECK(window.rmse[1].value < 1e-6);
  }
}

TEST_CASE("a loud output doesn't hide a quiet one: windows are judged in units of noise") {
  Calibration calibration = make_calibration(make_five_hole(), FiveHoleTruth{}.parameters);
  calibration.fit.noise = {{"vn", 1.0}, {"ve", 0.01}, {"vd", 1.0}};
  SimulatedFlight simulated = simulate_five_hole(quiet(FiveHoleTruth{}), condensed(rows));
  for (SimulatedColumn& column : simulated.columns) {
    if (column.name == "vn_mps") column.values[50] += 4.0;
    if (column.name == "ve_mps") column.values[250] += 0.5;
  }
  const Comparison result = compare(calibration, make_flight(simulated));
  CHECK(result.windows[0].first_s == result.time[240]);
  CHECK(result.windows[1].first_s == result.time[40]);
}

TEST_CASE("channels and windows in the JSON, and none of a flight too short for them") {
  const Comparison result = compare_with([](std::size_t row) { return at(row); });
  const auto root = nlohmann::json::parse(to_json(result));
  REQUIRE(root["channels"].size() == result.channels.size());
  const auto& channel = root["channels"][0];
  CHECK(channel["driver"] == result.channels[0].driver);
  CHECK(channel["output"] == "vn");
  CHECK(channel["share_line"].get<double>() == result.channels[0].share_line);
  CHECK(channel["share_smooth"].get<double>() == result.channels[0].share_smooth);
  CHECK(channel["slope"].get<double>() == result.channels[0].slope);
  CHECK(channel["slope_error"].get<double>() == result.channels[0].slope_error);
  CHECK(channel["unit"] == result.channels[0].unit);
  REQUIRE(root["windows"].size() == 5);
  CHECK(root["windows"][0]["rows"] == 20);
  CHECK(root["windows"][0]["rmse"]["vn"].get<double>() == result.windows[0].rmse[0].value);
  CHECK(root["windows"][0]["mean"]["vn"].get<double>() == result.windows[0].mean[0].value);

  const Flight brief = make_flight(simulate_five_hole(quiet(FiveHoleTruth{}), condensed(12)));
  const Comparison small =
      compare(make_calibration(make_five_hole(), FiveHoleTruth{}.parameters), brief);
  CHECK(small.channels.empty());
  CHECK(small.windows.size() == 2);
}

}  // namespace comparison_channels_test
