// SPDX-License-Identifier: BSD-3-Clause
// Effects hidden in a magnetometer's flight, against their definitions written out by hand on the
// logged attitude, field and columns.
#include <doctest/doctest.h>
#include <cmath>
#include <functional>

#include "numerics/decompositions.hpp"
#include "simulated_flights.hpp"

namespace simulate_hidden_magnetometer_test {

namespace {

using namespace sepcal;
using namespace sepcal::test;

const std::vector<double> nine{0.01, -0.02, 0.03, 0.02, 0.01, -0.01, 0.015, 0.005, -0.03};

/// The sensor's matrix C, from the parameters (Eq. B1).
Matrix3d sensor_matrix(const MagnetometerTruth& truth) {
  const auto x = [&](const char* name) { return truth.parameters.at(name); };
  Matrix3d soft_iron;
  soft_iron << 1, x("alpha_xy"), x("alpha_xz"),  //
      x("alpha_xy"), 1, x("alpha_yz"),           //
      x("alpha_xz"), x("alpha_yz"), 1;
  return soft_iron * (Matrix3d::Identity() + cross_matrix({x("eta_x"), x("eta_y"), x("eta_z")})) *
         Vector3d(1 + x("lambda_x"), 1 + x("lambda_y"), 1 + x("lambda_z")).asDiagonal();
}

using ByHand = std::function<Vector3d(const SimulatedFlight&, std::size_t row, const Vector3d& h)>;

/// Every reading is C (h + turned) + n + added, h from the logged attitude and field.
void check_effect(const SizedEffect& effect, const ByHand& added, const ByHand& turned = {}) {
  CAPTURE(effect.name);
  const MagnetometerTruth truth = quiet(MagnetometerTruth{});
  const SimulatedFlight plain = simulate_magnetometer(truth, condensed(300));
  const SimulatedFlight flight = simulate_magnetometer(hiding(truth, {effect}), condensed(300));
  const auto x = [&](const char* name) { return truth.parameters.at(name); };
  double worst = 0, largest = 0;
  for (std::size_t k = 0; k < flight.rows(); ++k) {
    const Vector3d h = body_to_ned(flight, k).transpose() * at(flight, earth_field, k);
    Vector3d expected = Vector3d(x("n_x"), x("n_y"), x("n_z"));
    expected += sensor_matrix(truth) * (turned ? Vector3d(h + turned(flight, k, h)) : h);
    if (added) expected += added(flight, k, h);
    worst = std::max(worst, (at(flight, reading, k) - expected).norm());
    largest = std::max(largest, (at(flight, reading, k) - at(plain, reading, k)).norm());
  }
  CHECK(worst < 1e-11);
  CHECK(largest > 0.1);  // the effect is at work
}

}  // namespace

TEST_CASE("a driven scale stretches the field, together or axis by axis") {
  check_effect({"scale[current_a]", {0.002}},
               [](const SimulatedFlight& flight, std::size_t k, const Vector3d& h) -> Vector3d {
                 return 0.002 * at(flight, "current_a", k) * h;
               });
  check_effect({"axis_scale[voltage_v]", {0.001, -0.002, 0.003}},
               [](const SimulatedFlight& flight, std::size_t k, const Vector3d& h) -> Vector3d {
                 const double volts = at(flight, "voltage_v", k);
                 return {0.001 * volts * h[0], -0.002 * volts * h[1], 0.003 * volts * h[2]};
               });
}

TEST_CASE("a cubic nonlinearity bends each axis by itself") {
  check_effect({"cubic_nonlinearity", {1e-6, -2e-6, 3e-6, 1e-4, 2e-4, -1e-4}},
               [](const SimulatedFlight&, std::size_t, const Vector3d& h) -> Vector3d {
                 return {1e-6 * std::pow(h[0], 3) + 1e-4 * std::pow(h[0], 2),
                         -2e-6 * std::pow(h[1], 3) + 2e-4 * std::pow(h[1], 2),
                         3e-6 * std::pow(h[2], 3) - 1e-4 * std::pow(h[2], 2)};
               });
}

TEST_CASE("eddy currents follow the field's rate in body axes") {
  const Matrix3d E = (Matrix3d() << 0.01, -0.02, 0.03, 0.02, 0.01, -0.01, 0.015, 0.005, -0.03)
                         .finished();  // by rows
  check_effect({"eddy_currents", nine},
               [&](const SimulatedFlight& flight, std::size_t k, const Vector3d& h) -> Vector3d {
                 return E * -at(flight, rates, k).cross(h);
               });
  // And -w x h is the rate: numeric differences of the field in body axes, 1,500 rows a second.
  const SimulatedFlight flight =
      simulate_magnetometer(quiet(MagnetometerTruth{}), condensed(120000));
  const auto field = [&](std::size_t k) -> Vector3d {
    return body_to_ned(flight, k).transpose() * at(flight, earth_field, k);
  };
  for (std::size_t k = 1; k + 1 < flight.rows(); k += 997) {
    const double span = at(flight, "time_s", k + 1) - at(flight, "time_s", k - 1);
    const Vector3d numeric = (field(k + 1) - field(k - 1)) / span;
    REQUIRE((numeric + at(flight, rates, k).cross(field(k))).norm() < 2e-3);  // of 100 uT/s
  }
}

TEST_CASE("the true field is turned by the declination's error") {
  const double c = std::cos(0.1), s = std::sin(0.1);
  const Matrix3d turn = (Matrix3d() << c, -s, 0, s, c, 0, 0, 0, 1).finished();  // about down
  check_effect({"field_declination", {0.1}}, {},
               [&](const SimulatedFlight& flight, std::size_t k, const Vector3d& h) -> Vector3d {
                 return body_to_ned(flight, k).transpose() * turn * at(flight, earth_field, k) - h;
               });
}

TEST_CASE("an attitude's bias turns the field in body axes") {
  check_effect({"attitude_bias", {0.02, -0.03}}, {},
               [](const SimulatedFlight&, std::size_t, const Vector3d& h) -> Vector3d {
                 return {0.03 * h[2], 0.02 * h[2], -0.03 * h[0] - 0.02 * h[1]};
               });
}

TEST_CASE("a late magnetometer logs what it read before") {
  const MagnetometerTruth truth = quiet(MagnetometerTruth{});
  const SimulationOptions options{.rate = 50.0};
  const SimulatedFlight plain = simulate_magnetometer(truth, options);
  const SimulatedFlight late =
      simulate_magnetometer(hiding(truth, {{"time_offset", {0.06}}}), options);
  for (const char* axis : reading) {
    CHECK(worst_difference(late, plain, axis, 3) < 1e-10);
    CHECK(worst_difference(late, plain, axis) > 0.1);
  }
  for (const char* angle : angles) CHECK(worst_difference(late, plain, angle) == 0);
}

TEST_CASE("a lagging magnetometer keeps its equation") {
  const MagnetometerTruth truth = quiet(MagnetometerTruth{});
  const SimulatedFlight plain = simulate_magnetometer(truth, condensed(16000));
  for (const double tau : {0.3, 0.002}) {
    CAPTURE(tau);
    const SimulatedFlight lagging =
        simulate_magnetometer(hiding(truth, {{"sensor_lag", {tau}}}), condensed(16000));
    for (const char* axis : reading) {
      const Eigen::ArrayXd undone = undo_lag(lagging, axis, tau);
      const Eigen::ArrayXd whole = values(plain, axis);
      CHECK((undone - whole.segment(2, undone.size())).abs().maxCoeff() < 1e-3);
      CHECK(worst_difference(lagging, plain, axis) > 0.1 * tau / 0.3);
    }
  }
}

TEST_CASE("without its own attitude the sensor is the same") {
  const MagnetometerTruth truth = quiet(MagnetometerTruth{});
  const SimulatedFlight flight = simulate_magnetometer(
      hiding(truth, {{"bias[current_a]", {0.2}}, {"axis_scale[throttle]", {0.02}}}),
      condensed(300));
  // |C^-1 (m - n)| is the field's strength once the effects are undone.
  const double strength = Vector3d(truth.field.data()).norm();
  for (std::size_t k = 0; k < flight.rows(); ++k) {
    Matrix3d C = sensor_matrix(truth);
    C.diagonal().array() += 0.02 * at(flight, "throttle", k);
    const Vector3d n = Vector3d(truth.parameters.at("n_x"), truth.parameters.at("n_y"),
                                truth.parameters.at("n_z")) +
                       Vector3d::Constant(0.2 * at(flight, "current_a", k));
    REQUIRE(C.lu().solve(at(flight, reading, k) - n).norm() ==
            doctest::Approx(strength).epsilon(1e-12));
  }
}

}  // namespace simulate_hidden_magnetometer_test
