// SPDX-License-Identifier: BSD-3-Clause
// A probe corrects what a simulated one reads: the air at the sensor comes back from the wind
// triangle, the field from the attitude, neither by way of the probe's own equations.
#include "sepcal/flight/probe.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibrated_flights.hpp"

namespace probe_test {

using namespace sepcal;
using namespace sepcal::test;

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// The air's velocity at the probe in body axes: C_n^b (V - W) + w x r.
Vector3d air_at_probe(const SimulatedFlight& flight, std::size_t row, const FiveHoleTruth& truth) {
  const auto& x = truth.parameters;
  const Vector3d wind(x.at("w_n"), x.at("w_e"), x.at("w_d"));
  return body_to_ned(flight, row).transpose() * (at(flight, velocity, row) - wind) +
         cross_matrix(at(flight, rates, row)) * Vector3d(truth.lever_arm.data());
}

std::vector<CorrectedColumn> correct(const Probe& probe, const SimulatedFlight& flight) {
  return probe.correct(probe.read(make_flight(flight), {}), order_values(probe, flight.truth), {});
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

TEST_CASE("a Pitot-static tube corrected with the truth reads the true airspeed") {
  const PitotStaticTruth truth = quiet(PitotStaticTruth{});
  const SimulatedFlight flight = simulate_pitot_static(truth, condensed(300));
  const auto probe = pitot_static_probe();
  const auto corrected = correct(*probe, flight);
  REQUIRE(corrected.size() == 1);
  const Vector3d wind(truth.parameters.at("w_n"), truth.parameters.at("w_e"), 0.0);
  for (std::size_t row = 0; row < flight.rows(); ++row) {
    const double airspeed = (at(flight, velocity, row) - wind).norm();
    REQUIRE(corrected[0].values[row] == doctest::Approx(airspeed).epsilon(1e-12));
  }
}

TEST_CASE("a magnetometer calibrated by strength alone reads a field of that strength") {
  MagnetometerTruth truth = quiet(MagnetometerTruth{});
  for (const char* name : {"eta_x", "eta_y", "eta_z"}) truth.parameters[name] = 0.0;
  const SimulatedFlight flight = simulate_magnetometer(truth, condensed(300));
  const auto probe = attitude_independent_probe(Vector3d(truth.field.data()).norm());
  const ProbeReadings readings = probe->read(make_flight(flight), {});
  CHECK(readings.notes.back().find("up to a rotation") != std::string::npos);
  const auto corrected = probe->correct(readings, order_values(*probe, flight.truth), {});
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
  check_refused([&] { probe->read(flight, {}); }, {"flight row 5", "'dpa_pa'", "drop_invalid"});

  const ProbeReadings readings = probe->read(flight, {.drop_invalid = true});
  for (const auto& column : probe->correct(readings, order_values(*probe, simulated.truth), {})) {
    REQUIRE(column.values.size() == 20);
    for (std::size_t row = 0; row < 20; ++row) {
      CHECK(std::isnan(column.values[row]) == (row == 3 || row == 5));
    }
  }
}

TEST_CASE("a singular C can't be applied") {
  const auto probe = magnetometer_probe(std::nullopt);
  const ProbeReadings readings =
      probe->read(make_flight(simulate_magnetometer({}, condensed(5))), {});
  const auto apply = [&](const std::string& name, double value) {
    return [&, name, value] { probe->correct(readings, only(*probe, name, value), {}); };
  };
  check_refused(apply("lambda_y", -1.0), {"C is singular", "more attitudes"});
  check_refused(apply("alpha_xy", 1.0), {"C is singular", "more attitudes"});
  CHECK_NOTHROW(apply("alpha_xy", 0.9)());
}

TEST_CASE("a tube whose scale is zero can't be applied") {
  const auto probe = pitot_static_probe();
  const ProbeReadings readings =
      probe->read(make_flight(simulate_pitot_static({}, condensed(5))), {});
  const Eigen::VectorXd values = Eigen::VectorXd::Zero(5);
  check_refused([&] { probe->correct(readings, values, {}); }, {"s_va is zero", "airspeed"});
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
  const auto tube = pitot_static_probe();
  CHECK(tube->name() == "pitot-static");
  CHECK(tube->app() == "sepcal-pitot");
  CHECK(tube->corrected_headers() == std::vector<std::string>{"airspeed_cal_mps"});
  const auto strength = attitude_independent_probe(48);
  CHECK(strength->name() == "magnetometer-norm");
  CHECK(strength->app() == "sepcal-mag");
  CHECK(strength->corrected_headers() == magnetometer->corrected_headers());
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

  CHECK(make_probe("pitot-static", {})->settings().empty());
  const std::map<std::string, std::vector<double>> strength{{"field_strength", {48.0}},
                                                            {"field_noise", {0.3}}};
  CHECK(attitude_independent_probe(48.0, 0.3)->settings() == strength);
  CHECK(make_probe("magnetometer-norm", strength)->settings() == strength);
  const std::map<std::string, std::vector<double>> of_readings{{"field_strength", {}},
                                                               {"field_noise", {0.0}}};
  CHECK(attitude_independent_probe(std::nullopt)->settings() == of_readings);
  CHECK(make_probe("magnetometer-norm", of_readings)->settings() == of_readings);
}

TEST_CASE("for effects a record has the flow angles as read and the temperature in K") {
  SimulatedFlight simulated = simulate_five_hole({}, condensed(20));
  const auto prepare = [&] {
    return five_hole_probe(4.0, 5.0, {})->prepare(make_flight(simulated), {.drop_invalid = true});
  };
  const ProbeRecord prepared = prepare();
  for (std::size_t row = 0; row < 20; ++row) {
    const double pressure = at(simulated, "pt_pa", row) - at(simulated, "ps_pa", row);
    CHECK(prepared.record.column("alpha")[row] ==
          doctest::Approx(at(simulated, "dpa_pa", row) / (4.0 * pressure)).epsilon(1e-14));
    CHECK(prepared.record.column("beta")[row] ==
          doctest::Approx(at(simulated, "dpb_pa", row) / (5.0 * pressure)).epsilon(1e-14));
  }
  CHECK(std::ranges::equal(prepared.record.column("temperature"), simulated.column("temp_k")));
  for (SimulatedColumn& column : simulated.columns) {
    if (column.name == "temp_k") column.values[3] = not_a_number;
  }
  CHECK_FALSE(prepare().record.has("temperature"));  // the logged density does without it
  CHECK(prepare().rows_used() == 20);
}

TEST_CASE("body rates are needed with a lever arm, else they are not") {
  SimulatedFlight simulated = simulate_five_hole({}, condensed(20));
  std::erase_if(simulated.columns, [](const auto& column) { return column.name == "q_radps"; });
  const Flight flight = make_flight(simulated);
  CHECK(five_hole_probe(4.5, 4.5, {0, 0, 0})->prepare(flight, {}).rows_used() == 20);
  check_refused([&] { make_five_hole()->prepare(flight, {}); },
                {"'q_radps' is missing", "the flight has: time_s, "});
}

TEST_CASE("what no probe is, is refused") {
  for (const double k : {0.0, -4.5, infinite, not_a_number}) {
    check_refused([&] { five_hole_probe(k, 4.5, {}); }, {"k_alpha", "1/rad", "above zero"});
    check_refused([&] { five_hole_probe(4.5, k, {}); }, {"k_beta", "1/rad", "above zero"});
  }
  check_refused([] { five_hole_probe(4.5, 4.5, {0, infinite, 0}); }, {"lever_arm", "metres"});
  check_refused([] { make_probe("venturi", {}); },
                {"'venturi'", "five-hole, vane-boom, pitot-static, magnetometer"});
  check_refused([] { make_probe("five-hole", {{"k_alpha", {4.5}}, {"lever_arm", {0, 0, 0}}}); },
                {"'k_beta'", "1 number"});
  check_refused(
      [] {
        make_probe("five-hole", {{"k_alpha", {4.5}}, {"k_beta", {4.5}}, {"lever_arm", {0, 0}}});
      },
      {"'lever_arm'", "3 numbers"});
  check_refused([] { make_probe("magnetometer", {{"field", {48.0}}}); }, {"'field'", "3 numbers"});
  for (const double strength : {0.0, -48.0, infinite, not_a_number}) {
    check_refused([&] { attitude_independent_probe(strength); },
                  {"field_strength is", "in uT, above zero"});
  }
  check_refused([] { attitude_independent_probe(48, -1); }, {"field_noise is -1"});
  check_refused([] { make_probe("magnetometer-norm", {}); }, {"'field_strength'", "1 number"});
}

}  // namespace probe_test
