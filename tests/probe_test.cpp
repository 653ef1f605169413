// SPDX-License-Identifier: BSD-3-Clause
// A probe corrects what a simulated one reads: the air at the sensor comes back from the wind
// triangle, the field from the attitude, neither by way of the probe's own equations.
#include "sepcal/flight/probe.hpp"

#include <cmath>
#include <limits>

#include "calibrated_flights.hpp"

using namespace sepcal;
using namespace sepcal::test;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// The air's velocity at the probe in body axes: C_n^b (V - W) + w x r.
Vector3d air_at_probe(const SimulatedFlight& flight, std::size_t row, const FiveHoleTruth& truth) {
  const auto& x = truth.parameters;
  const Vector3d wind(x.at("w_n"), x.at("w_e"), x.at("w_d"));
  return body_to_ned(flight, row).transpose() * (at(flight, velocity, row) - wind) +
         cross_matrix(at(flight, rates, row)) * Vector3d(truth.lever_arm.data());
}

std::vector<CorrectedColumn> correct(const Probe& probe, const SimulatedFlight& flight) {
  return probe.correct(probe.read(make_flight(flight), false), order_values(probe, flight.truth));
}

/// A magnetometer's parameters, all zero but one.
Eigen::VectorXd only(const Probe& probe, const std::string& name, double value) {
  std::map<std::string, double> values = MagnetometerTruth{}.parameters;
  for (auto& [each, entry] : values) entry = each == name ? value : 0.0;
  return order_values(probe, values);
}

}  // namespace

TEST_CASE("a five-hole probe corrected with the truth reads the true air") {
  const FiveHoleTruth truth = quiet(FiveHoleTruth{});
  const SimulatedFlight flight = simulate_five_hole(truth, condensed(300));
  const auto probe = make_five_hole();
  const auto corrected = correct(*probe, flight);
  REQUIRE(corrected.size() == 3);
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    const Vector3d air = air_at_probe(flight, row, truth);
    REQUIRE(corrected[0].values[row] == doctest::Approx(air.norm()).epsilon(1e-10));
    REQUIRE(std::abs(corrected[1].values[row] - std::atan2(air[2], air[0])) < 1e-10);
    REQUIRE(std::abs(corrected[2].values[row] - std::asin(air[1] / air.norm())) < 1e-10);
  }
}

TEST_CASE("a magnetometer corrected with the truth reads the field in body axes") {
  const MagnetometerTruth truth = quiet(MagnetometerTruth{});
  const SimulatedFlight flight = simulate_magnetometer(truth, condensed(300));
  const auto probe = magnetometer_probe(truth.field);
  const auto corrected = correct(*probe, flight);
  REQUIRE(corrected.size() == 3);
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    const Vector3d field = body_to_ned(flight, row).transpose() * Vector3d(truth.field.data());
    const Vector3d read(corrected[0].values[row], corrected[1].values[row],
                        corrected[2].values[row]);
    REQUIRE((read - field).norm() < 1e-11);
  }
}

TEST_CASE("rows without air to read, and rows that are dropped, have no correction") {
  SimulatedFlight simulated = simulate_five_hole({}, condensed(20));
  simulated.columns[10].values[3] = 0.0;
  simulated.columns[12].values[5] = not_a_number;
  REQUIRE(simulated.columns[10].name == "pt_pa");
  REQUIRE(simulated.columns[12].name == "dpa_pa");
  const Flight flight = make_flight(simulated);
  const auto probe = make_five_hole();
  check_refused([&] { probe->read(flight, false); }, {"flight row 5", "'dpa_pa'", "drop_invalid"});

  const ProbeReadings readings = probe->read(flight, true);
  for (const auto& column : probe->correct(readings, order_values(*probe, simulated.truth))) {
    REQUIRE(column.values.size() == 20);
    for (std::size_t row = 0; row < 20; ++row) {
      CHECK(std::isnan(column.values[row]) == (row == 3 || row == 5));
    }
  }
}

TEST_CASE("a singular C can't be applied") {
  const auto probe = magnetometer_probe(std::nullopt);
  const ProbeReadings readings =
      probe->read(make_flight(simulate_magnetometer({}, condensed(5))), false);
  const auto apply = [&](const std::string& name, double value) {
    return [&, name, value] { probe->correct(readings, only(*probe, name, value)); };
  };
  check_refused(apply("lambda_y", -1.0), {"C is singular", "more attitudes"});
  check_refused(apply("alpha_xy", 1.0), {"C is singular", "more attitudes"});
  CHECK_NOTHROW(apply("alpha_xy", 0.9)());
}

TEST_CASE("names, apps and headers are those of the interface") {
  const auto five_hole = make_five_hole();
  CHECK(five_hole->name() == "five-hole");
  CHECK(five_hole->app() == "sepcal-pitot");
  CHECK(five_hole->corrected_headers() ==
        std::vector<std::string>{"airspeed_cal_mps", "alpha_cal_rad", "beta_cal_rad"});
  const auto magnetometer = magnetometer_probe(std::nullopt);
  CHECK(magnetometer->name() == "magnetometer");
  CHECK(magnetometer->app() == "sepcal-mag");
  CHECK(magnetometer->corrected_headers() ==
        std::vector<std::string>{"mx_cal_ut", "my_cal_ut", "mz_cal_ut"});
}

TEST_CASE("a probe is made again from its name and settings") {
  const auto probe = five_hole_probe(4.5, 5.5, {0.35, -0.1, 0.02});
  const std::map<std::string, std::vector<double>> settings{
      {"k_alpha", {4.5}}, {"k_beta", {5.5}}, {"lever_arm", {0.35, -0.1, 0.02}}};
  CHECK(probe->settings() == settings);
  CHECK(make_probe("five-hole", settings)->settings() == settings);

  const std::map<std::string, std::vector<double>> field{{"field", {19.7, -1.4, 49.4}}};
  CHECK(magnetometer_probe({{19.7, -1.4, 49.4}})->settings() == field);
  CHECK(make_probe("magnetometer", field)->settings() == field);
  CHECK(magnetometer_probe(std::nullopt)->settings().empty());
  CHECK(make_probe("magnetometer", {})->settings().empty());
}

TEST_CASE("body rates are needed with a lever arm, else they are not") {
  SimulatedFlight simulated = simulate_five_hole({}, condensed(20));
  std::erase_if(simulated.columns, [](const auto& column) { return column.name == "q_radps"; });
  const Flight flight = make_flight(simulated);
  CHECK(five_hole_probe(4.5, 4.5, {0, 0, 0})->prepare(flight, false).rows_used() == 20);
  check_refused([&] { make_five_hole()->prepare(flight, false); },
                {"'q_radps' is missing", "the flight has: time_s, "});
}

TEST_CASE("what no probe is, is refused") {
  for (const double k : {0.0, -4.5, infinite, not_a_number}) {
    check_refused([&] { five_hole_probe(k, 4.5, {}); }, {"k_alpha", "1/rad", "above zero"});
    check_refused([&] { five_hole_probe(4.5, k, {}); }, {"k_beta", "1/rad", "above zero"});
  }
  check_refused([] { five_hole_probe(4.5, 4.5, {0, infinite, 0}); }, {"lever_arm", "metres"});
  check_refused([] { make_probe("venturi", {}); }, {"'venturi'", "five-hole, magnetometer"});
  check_refused([] { make_probe("five-hole", {{"k_alpha", {4.5}}, {"lever_arm", {0, 0, 0}}}); },
                {"'k_beta'", "1 number"});
  check_refused(
      [] {
        make_probe("five-hole", {{"k_alpha", {4.5}}, {"k_beta", {4.5}}, {"lever_arm", {0, 0}}});
      },
      {"'lever_arm'", "3 numbers"});
  check_refused([] { make_probe("magnetometer", {{"field", {48.0}}}); }, {"'field'", "3 numbers"});
}
