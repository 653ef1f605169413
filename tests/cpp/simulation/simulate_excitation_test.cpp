// SPDX-License-Identifier: BSD-3-Clause
// Rich and poor flights: how much the vehicle moves, and how freely the columns that can drive an
// effect run.
#include <doctest/doctest.h>
#include <cmath>
#include <numbers>
#include <set>

#include "calibrated_flights.hpp"
#include "numerics/decompositions.hpp"
#include "simulated_flights.hpp"

namespace simulate_excitation_test {

namespace {

using namespace sepcal;
using namespace sepcal::test;
using Eigen::ArrayXd;

SimulationOptions flown(Excitation excitation, std::size_t rows = 400) {
  SimulationOptions options = condensed(rows);
  options.excitation = excitation;
  return options;
}

constexpr double degree = std::numbers::pi / 180;

double span(const ArrayXd& x) { return x.maxCoeff() - x.minCoeff(); }

/// The share of a column's variance that a constant and `others` explain by least squares.
double explained(const SimulatedFlight& flight, const char* name,
                 const std::vector<const char*>& others) {
  const Eigen::VectorXd y = values(flight, name) - values(flight, name).mean();
  Eigen::MatrixXd M(y.size(), static_cast<Eigen::Index>(others.size()));
  for (std::size_t j = 0; j < others.size(); ++j) {
    M.col(static_cast<Eigen::Index>(j)) =
        values(flight, others[j]) - values(flight, others[j]).mean();
  }
  const Eigen::VectorXd left = y - M * M.colPivHouseholderQr().solve(y);
  return 1 - left.squaredNorm() / y.squaredNorm();
}

}  // namespace

TEST_CASE("a poor flight goes straight on") {
  for (const std::size_t rows : {std::size_t{0}, std::size_t{400}}) {
    for (const SimulatedFlight& flight :
         {simulate_five_hole({}, flown(Excitation::poor, rows)),
          simulate_pitot_static({}, flown(Excitation::poor, rows))}) {
      CHECK(span(values(flight, "yaw_rad")) < 2 * degree);
      CHECK(span(values(flight, "roll_rad")) < 1 * degree);
      CHECK(values(flight, "q_radps").abs().maxCoeff() < 0.02);
      CHECK(span(values(flight, "pitch_rad")) > 0.1 * degree);  // small motions, but some
      const std::set<std::string> labels(flight.maneuver.begin(), flight.maneuver.end());
      CHECK(labels == std::set<std::string>{"cruise"});
      const ArrayXd vn = values(flight, "vn_mps");
      CHECK(vn.maxCoeff() < 20);
      CHECK(vn.minCoeff() > 6);
    }
  }
}

TEST_CASE("a poor magnetometer stays near level and near one heading") {
  const SimulatedFlight flight =
      simulate_magnetometer(quiet(MagnetometerTruth{}), flown(Excitation::poor, 2000));
  for (const char* angle : {"roll_rad", "pitch_rad"}) {
    CHECK(values(flight, angle).abs().maxCoeff() <= 16 * degree);
    CHECK(values(flight, angle).abs().maxCoeff() > 15 * degree);
  }
  CHECK(span(values(flight, "yaw_rad")) <= 90 * degree);
  CHECK(span(values(flight, "yaw_rad")) > 85 * degree);
}

TEST_CASE("a third of the sphere of field directions in body axes is covered") {
  MagnetometerTruth truth = quiet(MagnetometerTruth{});
  for (auto& [name, value] : truth.parameters) value = 0;
  for (const std::array<double, 3>& field :
       {truth.field, std::array{17.0, 3.0, -45.0}, std::array{30.0, 0.0, 0.0}}) {
    truth.field = field;
    const SimulatedFlight flight = simulate_magnetometer(truth, flown(Excitation::third, 3000));
    Eigen::Matrix3Xd seen(3, static_cast<Eigen::Index>(flight.rows()));
    for (std::size_t k = 0; k < flight.rows(); ++k) {
      const Vector3d h = body_to_ned(flight, k).transpose() * Vector3d(field.data());
      REQUIRE((h - at(flight, reading, k)).norm() < 1e-11);
      seen.col(static_cast<Eigen::Index>(k)) = h.normalized();
    }
    // Evenly spread directions (Fibonacci's lattice) within 4 deg of a row: a third, and a rim of
    // 4 deg round the patch, whose outline is about 9 rad: 0.05 of the sphere.
    constexpr int points = 4000;
    int near = 0;
    for (int i = 0; i < points; ++i) {
      const double z = 1 - (2 * i + 1.0) / points;
      const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
      const double r = std::sqrt(1 - z * z);
      const Vector3d d(r * std::cos(turn), r * std::sin(turn), z);
      if ((d.transpose() * seen).maxCoeff() > std::cos(4 * degree)) ++near;
    }
    CHECK(near > points / 3);
    CHECK(near < points * (1.0 / 3 + 0.07));
  }
  // The attitude turns as the rates say, here as everywhere: C(t - h)' C(t + h) = I + 2h [w x].
  const SimulatedFlight fine = simulate_magnetometer(truth, flown(Excitation::third, 120000));
  for (std::size_t k = 1; k + 1 < fine.rows(); k += 997) {
    const Matrix3d turned = body_to_ned(fine, k - 1).transpose() * body_to_ned(fine, k + 1);
    const double time = at(fine, "time_s", k + 1) - at(fine, "time_s", k - 1);
    const Matrix3d rate = (turned - turned.transpose()) / (2 * time);
    REQUIRE((rate - cross_matrix(at(fine, rates, k))).cwiseAbs().maxCoeff() < 5e-5);
  }
}

TEST_CASE("what can drive an effect runs freely") {
  const std::vector<const char*> air{"roll_rad", "pitch_rad", "p_radps", "q_radps", "r_radps"};
  for (const Excitation excitation : {Excitation::rich, Excitation::poor}) {
    const SimulatedFlight probe = simulate_five_hole({}, flown(excitation));
    CHECK(explained(probe, "throttle", air) < 0.6);
    CHECK(explained(probe, "current_a", air) < 0.6);
    CHECK(explained(probe, "current_a", {"throttle"}) < 0.95);
    CHECK(span(values(probe, "throttle")) > 0.5);
    CHECK(values(probe, "throttle").minCoeff() >= 0);
    CHECK(values(probe, "throttle").maxCoeff() <= 1);
    const ArrayXd flap = values(probe, "flap");
    for (const double stage : {0.0, 1.0, 2.0}) CHECK((flap == stage).count() > 40);
    CHECK((flap != flap.round()).count() < 40);
    const SimulatedFlight magnetometer = simulate_magnetometer({}, flown(excitation));
    const std::vector<const char*> drivers{"temp_degc", "current_a", "throttle", "panel_current_a"};
    for (const char* driver : drivers) {
      CAPTURE(driver);
      std::vector<const char*> others{"time_s", "mx_ut", "my_ut", "mz_ut"};
      for (const char* other : drivers) {
        if (other != driver) others.push_back(other);
      }
      CHECK(explained(magnetometer, driver, others) < 0.95);
    }
    CHECK(explained(magnetometer, "voltage_v", {"time_s", "current_a"}) > 0.999);  // it sags
    CHECK(explained(magnetometer, "voltage_v", {"time_s"}) < 0.9);
  }
}

TEST_CASE("an excitation that there isn't") {
  CHECK(find_excitation("third") == Excitation::third);
  check_refused([] { find_excitation("lively"); }, {"'lively'", "rich, poor, third"});
  check_refused([] { simulate_five_hole({}, flown(Excitation::third)); },
                {"third", "magnetometer"});
  check_refused([] { simulate_pitot_static({}, flown(Excitation::third)); }, {"third"});
  MagnetometerTruth truth;
  truth.field = {0, 0, 0};
  check_refused([&] { simulate_magnetometer(truth, flown(Excitation::third)); }, {"field is zero"});
}

}  // namespace simulate_excitation_test
