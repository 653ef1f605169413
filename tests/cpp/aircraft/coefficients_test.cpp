// SPDX-License-Identifier: BSD-3-Clause
// Coefficients of a motion that is written down: forces and moments are known in closed form, and
// so is what an inertial unit away from the centre of gravity reads.
#include "sepcal/detail/aircraft/coefficients.hpp"

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "sepcal/error.hpp"

namespace coefficients_test {

using doctest::Approx;
using doctest::Contains;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using sepcal::aero_coefficients;
using sepcal::AeroCoefficients;
using sepcal::AircraftGeometry;
using sepcal::Error;
using sepcal::RateReference;
using sepcal::Record;

namespace {

const AircraftGeometry aircraft{.area = 16.2,
                                .chord = 1.49,
                                .span = 10.9,
                                .mass = 1000,
                                .inertia = {1285, 1825, 2667, 120},
                                .cg = {-0.3, 0.0, 0.1},
                                .imu = {0.4, 0.2, -0.3},
                                .vane = {1.5, -3.0, 0.2}};

/// A body whose rates are waves, in air of 1.2 kg/m^3, pushed by a force that is a wave too.
struct Truth {
  Vector3d rates;
  Vector3d rates_dot;
  Vector3d force;   // N, without weight; the thrust, 900 N forward, is in it
  Vector3d moment;  // N m, about the centre of gravity
  Vector3d air;     // m/s
};

Truth truth_at(double t) {
  Truth at;
  for (int i = 0; i < 3; ++i) {
    const double w = 1.1 + 0.4 * i;
    at.rates[i] = 0.3 * std::sin(w * t + i);
    at.rates_dot[i] = 0.3 * w * std::cos(w * t + i);
  }
  at.force = {500 + 100 * std::sin(t), 300 * std::cos(1.3 * t), -9800 + 800 * std::sin(0.7 * t)};
  Matrix3d inertia;
  inertia << 1285, 0, -120, 0, 1825, 0, -120, 0, 2667;
  at.moment = inertia * at.rates_dot + at.rates.cross(inertia * at.rates);
  at.air = {50, 3 * std::sin(t), 4 + std::cos(t)};
  return at;
}

Record fly(double interval = 0.02, bool with_derivatives = false) {
  std::map<std::string, std::vector<double>> columns;
  const char* names[] = {"ax", "ay", "az", "p", "q", "r", "pdot", "qdot", "rdot"};
  for (int k = 0; k < 300; ++k) {
    const double t = interval * k;
    const Truth at = truth_at(t);
    const Vector3d imu(0.7, 0.2, -0.4);  // from the centre of gravity
    const Vector3d vane(1.8, -3.0, 0.1);
    const Vector3d a =
        at.force / 1000 + at.rates_dot.cross(imu) + at.rates.cross(at.rates.cross(imu));
    const Vector3d air = at.air + at.rates.cross(vane);
    for (int i = 0; i < 3; ++i) {
      columns[names[i]].push_back(a[i]);
      columns[names[3 + i]].push_back(at.rates[i]);
      if (with_derivatives) columns[names[6 + i]].push_back(at.rates_dot[i]);
    }
    columns["time"].push_back(t);
    columns["airspeed"].push_back(air.norm());
    columns["alpha"].push_back(std::atan2(air[2], air[0]));
    columns["beta"].push_back(std::asin(air[1] / air.norm()));
    columns["rho"].push_back(1.2);
    columns["thrust"].push_back(900);
  }
  Record record;
  for (const auto& [name, values] : columns) record.add(name, values);
  return record;
}

Record without(const Record& record, const std::string& left_out) {
  Record rest;
  for (const std::string& name : record.names()) {
    const auto values = record.column(name);
    if (name != left_out) rest.add(name, {values.begin(), values.end()});
  }
  return rest;
}

Record with(const Record& record, const std::string& name, double scale, double offset = 0.0) {
  const auto values = record.column(name);
  std::vector<double> changed(values.begin(), values.end());
  for (double& value : changed) value = scale * value + offset;
  return without(record, name).add(name, changed);
}

void refuse(const Record& record, const char* message, AircraftGeometry geometry = aircraft) {
  CHECK_THROWS_WITH_AS(aero_coefficients(record, geometry), Contains(message), Error);
}

/// The largest error of each, relative to its largest value.
void check_coefficients(const AeroCoefficients& found, double tolerance) {
  const double S = 16.2;
  Eigen::Matrix<double, 6, 1> worst = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> size = worst;
  const char* names[] = {"CX", "CY", "CZ", "Cl", "Cm", "Cn"};
  for (std::size_t k = 0; k < found.record.length(); ++k) {
    const Truth at = truth_at(found.record.column("time")[k]);
    const double qbar = 0.6 * at.air.squaredNorm();
    const Vector3d arms(10.9, 1.49, 10.9);
    const Vector3d aero = at.force - Vector3d(900, 0, 0);
    for (int i = 0; i < 6; ++i) {
      const double expected =
          i < 3 ? aero[i] / (qbar * S) : at.moment[i - 3] / (qbar * S * arms[i - 3]);
      worst[i] = std::max(worst[i], std::abs(found.record.column(names[i])[k] - expected));
      size[i] = std::max(size[i], std::abs(expected));
    }
  }
  INFO(worst.transpose() << " of " << size.transpose());
  CHECK((worst.array() < tolerance * size.array()).all());
}

}  // namespace

TEST_CASE("coefficients are the forces and moments that moved the body, with Ixz and lever arms") {
  const AeroCoefficients exact = aero_coefficients(fly(0.02, true), aircraft);
  CHECK(exact.names.size() == 6);
  CHECK(std::isnan(exact.window));
  check_coefficients(exact, 1e-12);
  const AeroCoefficients differentiated = aero_coefficients(fly(), aircraft);
  CHECK(differentiated.window == Approx(0.12));
  CHECK(differentiated.notes[1] == "p, q and r are differentiated by a local cubic over 0.12 s");
  check_coefficients(differentiated, 2e-4);
}

TEST_CASE("flow and rates are those at the centre of gravity, by either reference") {
  for (const auto reference :
       {RateReference::chord_per_speed, RateReference::chord_per_twice_speed}) {
    AircraftGeometry geometry = aircraft;
    geometry.rate_reference = reference;
    const AeroCoefficients found = aero_coefficients(fly(), geometry);
    const bool twice = reference == RateReference::chord_per_twice_speed;
    CHECK(found.notes[0] == "q_hat is q " + std::string(twice ? "c/2V" : "c/V") +
                                ", p_hat and r_hat are p b/2V and r b/2V");
    for (const std::size_t k : {0U, 57U, 299U}) {
      const Truth at = truth_at(found.record.column("time")[k]);
      const double V = at.air.norm();
      CHECK(found.record.column("airspeed")[k] == Approx(V).epsilon(1e-12));
      CHECK(found.record.column("alpha")[k] ==
            Approx(std::atan2(at.air[2], at.air[0])).epsilon(1e-12));
      CHECK(found.record.column("p_hat")[k] == Approx(at.rates[0] * 10.9 / 2 / V).epsilon(1e-12));
      CHECK(found.record.column("q_hat")[k] ==
            Approx(at.rates[1] * 1.49 / (twice ? 2 : 1) / V).epsilon(1e-12));
    }
  }
}

TEST_CASE("forces alone need neither inertia nor rates, where the sensors sit at the centre") {
  AircraftGeometry geometry = aircraft;
  geometry.inertia = {};
  geometry.imu = geometry.vane = geometry.cg;
  Record record = fly();
  for (const char* name : {"p", "q", "r", "thrust"}) record = without(record, name);
  const AeroCoefficients found =
      aero_coefficients(record, geometry, {.coefficients = {"CZ", "CX"}});
  CHECK(found.names == std::vector<std::string>{"CX", "CZ"});
  CHECK(found.notes.back() == "CX holds the thrust: it isn't logged");
  CHECK(!found.record.has("q_hat"));
}

TEST_CASE("what is missing is named, with the way out") {
  const Record record = fly();
  refuse(without(record, "airspeed"), "column 'airspeed' is missing");
  refuse(without(record, "rho"), "add it, kg/m^3, or qbar, Pa");
  refuse(without(record, "ay"),
         "'ay' is missing, which CY needs; add it, m/s^2, a specific force: "
         "level flight reads az = -9.81; or leave CY out");
  refuse(without(record, "r"), "zeros where the maneuver keeps to the plane of symmetry");
  refuse(without(record, "time"), "pdot, qdot and rdot");
  refuse(without(record, "beta"), "the vane's lever arm needs; add it, or put vane where cg is");
  AircraftGeometry light = aircraft;
  light.inertia = {};
  refuse(record, "Cl needs the aircraft's inertia", light);
  CHECK_THROWS_WITH_AS(aero_coefficients(record, aircraft, {.window = 0.05}),
                       Contains("a window of 0.05 s holds 3 rows somewhere"), Error);
  CHECK_THROWS_WITH_AS(aero_coefficients(record, aircraft, {.coefficients = {"CL"}}),
                       Contains("there is no coefficient 'CL'"), Error);
}

TEST_CASE("degrees, g and the wrong sign of gravity are refused") {
  const Record record = fly();
  refuse(with(record, "az", -1), "level flight must read az = -9.81: turn its sign");
  refuse(with(record, "az", 1 / 9.81), "is it in g, or gravity taken out?");
  refuse(with(record, "az", 1, 9.81), "is it in g, or gravity taken out?");
  refuse(with(record, "p", 57.3), "'p' reaches 17 rad/s; it is probably in degrees");
  refuse(with(record, "alpha", 57.3 * 3), "'alpha' reaches");
  Record deflected = fly();
  deflected.add("elevator", std::vector<double>(300, -12.0));
  refuse(deflected, "'elevator' reaches -12 rad; it is probably in degrees");
}

}  // namespace coefficients_test
