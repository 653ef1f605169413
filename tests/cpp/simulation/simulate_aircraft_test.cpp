// SPDX-License-Identifier: BSD-3-Clause
// The simulated aircraft keeps the laws of mechanics, and its sensors read what they should.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "aircraft_records.hpp"
#include "sepcal/error.hpp"

namespace simulate_aircraft_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using sepcal::AircraftTruth;
using sepcal::Record;
using sepcal::simulate_aircraft;
using sepcal::SimulatedFlight;
using sepcal::test::record_of;
using sepcal::test::without_noise;

namespace {

Matrix3d attitude(const Record& record, std::size_t k) {
  return (AngleAxisd(record.column("yaw")[k], Vector3d::UnitZ()) *
          AngleAxisd(record.column("pitch")[k], Vector3d::UnitY()) *
          AngleAxisd(record.column("roll")[k], Vector3d::UnitX()))
      .toRotationMatrix();
}

Vector3d three(const Record& record, const char* x, const char* y, const char* z, std::size_t k) {
  return {record.column(x)[k], record.column(y)[k], record.column(z)[k]};
}

void refuse(const AircraftTruth& truth, const char* message) {
  CHECK_THROWS_WITH_AS(simulate_aircraft(truth), Contains(message), sepcal::Error);
}

}  // namespace

TEST_CASE("what the accelerometers read moves the aircraft, what the gyroscopes read turns it") {
  const Record record = record_of(simulate_aircraft(without_noise(), {.rate = 200}));
  double worst_move = 0.0;
  double worst_turn = 0.0;
  for (std::size_t k = 1; k + 1 < record.length(); ++k) {
    const Matrix3d R = attitude(record, k);
    const Vector3d gained =
        (three(record, "vn", "ve", "vd", k + 1) - three(record, "vn", "ve", "vd", k - 1)) / 0.01;
    const Vector3d read = R * three(record, "ax", "ay", "az", k) + Vector3d(0, 0, 9.80665);
    worst_move = std::max(worst_move, (gained - read).norm());
    const AngleAxisd turned(attitude(record, k - 1).transpose() * attitude(record, k + 1));
    const Vector3d rates = turned.angle() * turned.axis() / 0.01;
    worst_turn = std::max(worst_turn, (rates - three(record, "p", "q", "r", k)).norm());
  }
  CHECK(worst_move < 0.06);  // a surface's ramp bends the acceleration within 10 ms
  CHECK(worst_turn < 0.004);
}

TEST_CASE("it starts in level flight and every part of the flight is labelled") {
  const SimulatedFlight flight = simulate_aircraft(without_noise());
  const Record record = record_of(flight);
  CHECK(flight.rows() == 2001);
  CHECK(record.column("az")[0] == Approx(-9.80665).epsilon(1e-3));
  CHECK(record.column("vd")[0] == Approx(0).epsilon(1e-6));
  CHECK(record.column("airspeed")[0] == Approx(55));
  CHECK(record.column("pitch")[40] == Approx(record.column("pitch")[0]).epsilon(1e-6));
  CHECK(flight.maneuver[100] == "elevator_3211");
  CHECK(flight.maneuver[1100] == "rudder");
  CHECK(flight.maneuver[0] == "level");
}

TEST_CASE("sensors err as their truth says, at their own places") {
  AircraftTruth truth = without_noise();
  truth.geometry.imu = {0.5, 0.2, -0.1};
  truth.geometry.vane = {1.0, -4.0, 0.0};
  const Record exact = record_of(simulate_aircraft(without_noise()));
  for (const auto& [name, value] : std::map<std::string, double>{
           {"b_az", 0.2}, {"b_q", -0.003}, {"lambda_v", 0.03}, {"b_v", 0.5}, {"b_alpha", 0.01}}) {
    truth.parameters[name] = value;
  }
  const Record read = record_of(simulate_aircraft(truth));
  for (const std::size_t k : {80U, 210U, 730U, 1040U}) {
    const Vector3d w = three(exact, "p", "q", "r", k);
    const double V = exact.column("airspeed")[k];
    const double a = exact.column("alpha")[k];
    const double b = exact.column("beta")[k];
    const Vector3d air =
        V * Vector3d(std::cos(a) * std::cos(b), std::sin(b), std::sin(a) * std::cos(b)) +
        w.cross(Vector3d(1.0, -4.0, 0.0));
    CHECK(read.column("airspeed")[k] == Approx(1.03 * air.norm() + 0.5).epsilon(1e-9));
    CHECK(read.column("alpha")[k] == Approx(std::atan2(air[2], air[0]) + 0.01).epsilon(1e-9));
    CHECK(read.column("q")[k] == Approx(w[1] + 0.003).epsilon(1e-9));
  }
}

TEST_CASE("same seed, same flight; turbulence and process noise are another flight each") {
  AircraftTruth truth;
  truth.turbulence = 1.0;
  truth.process_noise = 0.02;
  const Record one = record_of(simulate_aircraft(truth, {.seed = 4}));
  const Record same = record_of(simulate_aircraft(truth, {.seed = 4}));
  const Record other = record_of(simulate_aircraft(truth, {.seed = 5}));
  CHECK(one.column("alpha")[900] == same.column("alpha")[900]);
  CHECK(one.column("alpha")[900] != other.column("alpha")[900]);
}

TEST_CASE("a hidden effect is at work, and written down") {
  AircraftTruth truth = without_noise();
  truth.effects = {{"Cm[alpha^2]", {2.0}}, {"accel_bias[time]", {0.0, 0.0, 0.01}}};
  const SimulatedFlight flight = simulate_aircraft(truth);
  CHECK(flight.effects == std::vector<std::string>{"Cm[alpha^2]", "accel_bias[time]"});
  CHECK(flight.truth.at("Cm[alpha^2].s") == 2.0);
  truth.effects = {{"wings", {1.0}}};
  refuse(truth, "'wings' is no effect of the simulated aircraft");
}

TEST_CASE("an aircraft that can't fly is refused") {
  AircraftTruth truth;
  truth.airspeed = 8.0;
  refuse(truth, "finds no level flight at 8 m/s");
  truth = {};
  truth.parameters["Cm_alpha"] = 0.5;
  refuse(truth, "the aircraft tumbles at ");
  truth = {};
  truth.parameters.erase("Cm_q");
  refuse(truth, "Cm_q");
  truth = {};
  truth.noise.erase("alpha");
  refuse(truth, "noise of 'alpha' is missing");
  truth = {};
  truth.geometry.inertia = {};
  refuse(truth, "has no inertia");
}

}  // namespace simulate_aircraft_test
