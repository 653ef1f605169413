// SPDX-License-Identifier: BSD-3-Clause
// Triads in canonical form and side by side (Eqs. A1-A5): tables, blocks, and a magnetometer with
// an accelerometer on one turning vehicle, simulated here entry by entry.
#include "sepcal/detail/static_concatenation.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "dense_reference.hpp"
#include "noises.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/models/scalar_examples.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/models/magnetometer.hpp"
#include "sepcal/models/triad.hpp"
#include "simulated_records.hpp"

namespace static_concatenation_test {

using doctest::Approx;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using sepcal::Accelerometer;
using sepcal::concatenate;
using sepcal::CrossCoupling;
using sepcal::Fit;
using sepcal::Labelled;
using sepcal::Magnetometer;
using sepcal::Misalignment;
using sepcal::Quantity;
using sepcal::Record;
using sepcal::StaticModel;
using sepcal::Triad;
using sepcal::Vec;
using sepcal::test::Draws;

namespace {

/// f = R(roll) [cos I, 0, sin I] times 50 uT, of which the inclination I is not known (xi').
struct DippingField {
  static constexpr std::array inputs{Quantity{"roll", "rad"}};
  static constexpr std::array outputs{Quantity{"mx", "uT"}, Quantity{"my", "uT"},
                                      Quantity{"mz", "uT"}};
  static constexpr std::array nonlinear{Quantity{"inclination", "rad", -1.5, 1.5}};
  template <class U, class X>
  Vec<X, 3> at(const Vec<U, 1>& u, const Vec<X, 1>& xi) const {
    using std::cos;
    using std::sin;
    return {50.0 * cos(xi[0]), 50.0 * sin(xi[0]) * sin(u[0]), 50.0 * sin(xi[0]) * cos(u[0])};
  }
};

constexpr auto both = [] {
  return concatenate(Labelled<"mag", Magnetometer>{}, Labelled<"acc", Accelerometer>{});
};

// Magnetometer: lambda, n [uT], eta, alpha. Accelerometer: lambda, n [m/s^2], eta.
constexpr std::array mag{0.04, -0.02, 0.03, 3.0, -5.0, 2.0, 0.02, -0.03, 0.015, 0.01, -0.02, 0.03};
constexpr std::array acc{0.01, -0.02, 0.015, 0.3, -0.2, 0.1, 0.01, 0.02, -0.015};

/// (C_alpha C_eta) (I + D) f + n, every entry written out.
Vector3d read_magnetometer(const Vector3d& f) {
  const auto [lx, ly, lz, nx, ny, nz, ex, ey, ez, xy, xz, yz] = mag;
  const double u = (1 + lx) * f[0];
  const double v = (1 + ly) * f[1];
  const double w = (1 + lz) * f[2];
  const double a = u - ez * v + ey * w;
  const double b = ez * u + v - ex * w;
  const double c = -ey * u + ex * v + w;
  return {a + xy * b + xz * c + nx, xy * a + b + yz * c + ny, xz * a + yz * b + c + nz};
}

Vector3d read_accelerometer(const Vector3d& f) {
  const auto [lx, ly, lz, nx, ny, nz, ex, ey, ez] = acc;
  const double u = (1 + lx) * f[0];
  const double v = (1 + ly) * f[1];
  const double w = (1 + lz) * f[2];
  return {u - ez * v + ey * w + nx, ez * u + v - ex * w + ny, -ey * u + ex * v + w + nz};
}

double quantise(double value, double step) { return step * std::round(value / step); }

/// A vehicle that is turned by hand every way, 400 samples: the field of 48 uT dips by 63 deg, the
/// hand shakes by 1 m/s^2. Noise of 0.3 uT and 0.05 m/s^2; readings in steps of 0.15 and 0.01.
Record turn(std::uint64_t seed) {
  constexpr int rows = 400;
  Draws draws(seed);
  MatrixXd columns(rows, 12);
  for (int k = 0; k < rows; ++k) {
    const double t = 0.1 * k;
    const double roll = 2.8 * std::sin(0.31 * t);
    const double pitch = 1.4 * std::sin(0.17 * t + 0.4);
    const double yaw = 0.23 * t;
    // From north-east-down by yaw, pitch and roll, one after another.
    const auto in_body = [&](const Vector3d& n) {
      const Vector3d a{std::cos(yaw) * n[0] + std::sin(yaw) * n[1],
                       -std::sin(yaw) * n[0] + std::cos(yaw) * n[1], n[2]};
      const Vector3d b{std::cos(pitch) * a[0] - std::sin(pitch) * a[2], a[1],
                       std::sin(pitch) * a[0] + std::cos(pitch) * a[2]};
      return Vector3d{b[0], std::cos(roll) * b[1] + std::sin(roll) * b[2],
                      -std::sin(roll) * b[1] + std::cos(roll) * b[2]};
    };
    const Vector3d h = in_body({48 * std::cos(1.1), 0, 48 * std::sin(1.1)});
    const Vector3d shake(std::sin(3.1 * t), std::sin(2.3 * t), std::sin(4.7 * t));
    const Vector3d f = in_body({0, 0, -9.81}) + shake;
    const Vector3d m = read_magnetometer(h) + 0.3 * draws.normal_matrix(3, 1);
    const Vector3d a = read_accelerometer(f) + 0.05 * draws.normal_matrix(3, 1);
    columns.row(k) << h.transpose(), f.transpose(),
        m.unaryExpr([](double x) { return quantise(x, 0.15); }).transpose(),
        a.unaryExpr([](double x) { return quantise(x, 0.01); }).transpose();
  }
  Record record;
  int next = 0;
  for (const char* name : {"hx", "hy", "hz", "fx", "fy", "fz", "mag.mx", "mag.my", "mag.mz",
                           "acc.ax", "acc.ay", "acc.az"}) {
    const auto column = columns.col(next++);
    record.add(name, {column.begin(), column.end()});
  }
  return record;
}

sepcal::FitOptions white() {
  sepcal::FitOptions options;
  options.samples = 50;
  options.coloured_errors = false;
  options.threads = 1;
  return options;
}

/// The truth by a parameter's name.
double truth_of(const std::string& name) {
  const auto at = [&](const auto& values, const sepcal::Tables& tables) {
    const auto parameters = tables.parameters();
    for (std::size_t k = 0; k < parameters.size(); ++k) {
      if (parameters[k].name == name.substr(4)) return values[k];
    }
    return std::nan("");
  };
  return name.starts_with("mag.") ? at(mag, sepcal::tables_of<Magnetometer>())
                                  : at(acc, sepcal::tables_of<Accelerometer>());
}

}  // namespace

TEST_CASE("a triad is N (I + D) f + n, with the factors' product in their order") {
  using Both = Triad<sepcal::FieldInBody, CrossCoupling, Misalignment>;
  Draws draws(31);
  for (int i = 0; i < 20; ++i) {
    const Vec<double, 6> xi1 = 0.3 * draws.normal_matrix(6, 1);
    const Vector3d alpha = 0.3 * draws.normal_matrix(3, 1);
    const Vector3d eta = 0.3 * draws.normal_matrix(3, 1);
    const Vector3d f = 40 * draws.normal_matrix(3, 1);
    Vec<double, 6> xi2;
    xi2 << alpha, eta;
    const auto z = Both{}.at(f, xi2);
    const Vector3d scaled = f + xi1.head<3>().cwiseProduct(f);
    const Vector3d turned = scaled + eta.cross(scaled);
    const Vector3d coupled(turned[0] + alpha[0] * turned[1] + alpha[1] * turned[2],
                           turned[1] + alpha[0] * turned[0] + alpha[2] * turned[2],
                           turned[2] + alpha[1] * turned[0] + alpha[2] * turned[1]);
    CHECK((z.A * xi1 + z.b - coupled - xi1.tail<3>()).norm() < 1e-12 * (1 + f.norm()));
    // The library's magnetometer is this triad with eta before alpha.
    Vec<double, 6> swapped;
    swapped << eta, alpha;
    CHECK((Magnetometer{}.at(f, swapped).A - z.A).norm() < 1e-13);
  }
}

TEST_CASE("what the reference doesn't know is a parameter, too, and derivatives are exact") {
  const StaticModel<Triad<DippingField, Misalignment>> model({});
  CHECK(model.tables().nonlinear[0].name == "inclination");
  CHECK(model.tables().linear[3].unit == "uT");
  Draws draws(32);
  Record record;
  record.add("roll", draws.uniform_column(7, -3, 3));
  for (const char* name : {"mx", "my", "mz"}) record.add(name, draws.uniform_column(7, -50, 50));
  const Eigen::VectorXd xi1 = 0.1 * draws.normal_matrix(6, 1);
  const Eigen::VectorXd xi2 = 0.3 * draws.normal_matrix(4, 1);
  const MatrixXd expected = sepcal::test::dense_rows(model, record, xi1, xi2);
  MatrixXd rows(21, 11);
  const std::array<const double*, 1> inputs{record.column("roll").data()};
  model.evaluate({inputs, 7, 0, true}, xi2.data(), xi1.data(), nullptr, rows);
  CHECK((rows.leftCols(10) - expected.leftCols(10)).norm() < 1e-8);
}

TEST_CASE("tables stand one after another, inputs of one name are one, A is block-diagonal") {
  const auto three = concatenate(Labelled<"a", Magnetometer>{}, sepcal::ScalarExample1{},
                                 Labelled<"b", Magnetometer>{});
  const auto tables = sepcal::tables_of<std::decay_t<decltype(three)>>();
  CHECK(tables.n_u() == 4);
  CHECK(tables.n_z() == 7);
  CHECK(tables.n_1() == 14);
  CHECK(tables.n_2() == 13);
  CHECK(tables.outputs[0].name == "a.mx");
  CHECK(tables.outputs[3].name == "z");
  CHECK(tables.linear[13].name == "b.n_z");
  CHECK(tables.linear[13].unit == "uT");
  CHECK(tables.nonlinear[0].lower == -0.5);
  tables.check_names();

  Draws draws(33);
  const Vec<double, 4> u = draws.normal_matrix(4, 1);
  const Vec<double, 13> xi2 = 0.2 * draws.normal_matrix(13, 1);
  const auto z = three.at(u, xi2);
  const auto a = Magnetometer{}.at(Vec<double, 3>(u.head<3>()), Vec<double, 6>(xi2.head<6>()));
  const auto c = sepcal::ScalarExample1{}.at(Vec<double, 1>(u[3]), Vec<double, 1>(xi2[6]));
  const auto b = Magnetometer{}.at(Vec<double, 3>(u.head<3>()), Vec<double, 6>(xi2.tail<6>()));
  MatrixXd expected = MatrixXd::Zero(7, 14);
  expected.topLeftCorner(3, 6) = a.A;
  expected.block(3, 6, 1, 2) = c.A;
  expected.bottomRightCorner(3, 6) = b.A;
  CHECK(z.A == expected);
  CHECK(z.b.head<3>() == a.b);
  CHECK(z.b[3] == c.b[0]);
  CHECK(z.b.tail<3>() == b.b);
}

TEST_CASE("guesses stand side by side, and there is none where a sensor has none") {
  Draws draws(34);
  const auto two = concatenate(Labelled<"a", Magnetometer>{}, Labelled<"b", Magnetometer>{});
  const MatrixXd h = 40 * draws.normal_matrix(12, 3);
  const MatrixXd z = h * (Matrix3d::Identity() + 0.1 * draws.normal_matrix(3, 3));
  MatrixXd readings(12, 6);
  readings << z, h;
  const MatrixXd guess = two.guess(h, readings);
  REQUIRE(guess.cols() == 1);
  CHECK(guess.topRows(6) == Magnetometer::guess(h, z));
  CHECK(guess.bottomRows(6) == Magnetometer::guess(h, h));
  MatrixXd u(12, 6);
  u << h, h;
  CHECK(both().guess(u, readings).cols() == 0);
}

TEST_CASE("a magnetometer and an accelerometer in one fit: the truth within standard errors") {
  // Of 40 seeds and 21 parameters: counts against the central 99.9 % of a binomial, one parameter
  // in 1,000 outside; the sum of squares over 840 numbers, whose standard deviation is 0.05.
  constexpr int seeds = 40;
  std::map<std::string, int> outside;
  double square = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    const Fit fit = sepcal::fit(both(), turn(static_cast<std::uint64_t>(seed)), white());
    REQUIRE(fit.status == sepcal::FitStatus::converged);
    REQUIRE(fit.parameters.size() == 21);
    for (const sepcal::Parameter& parameter : fit.parameters) {
      const double z = (parameter.value - truth_of(parameter.name)) / parameter.standard_error;
      outside[parameter.name] += std::abs(z) > 1.96 ? 1 : 0;
      square += z * z / (21.0 * seeds);
    }
  }
  for (const auto& [name, count] : outside) {
    INFO(name << " outside in " << count);
    CHECK_FALSE(sepcal::test::outside_binomial(count, seeds, 0.05));
  }
  MESSAGE("mean square of errors in standard errors: " << square);
  CHECK(std::abs(square - 1.0) < 0.2);
}

TEST_CASE("side by side they are what they are alone") {
  const Record record = turn(77);
  const Fit joint = sepcal::fit(both(), record, white());
  const Fit magnetometer = sepcal::fit(Labelled<"mag", Magnetometer>{}, record, white());
  const Fit accelerometer = sepcal::fit(Labelled<"acc", Accelerometer>{}, record, white());
  CHECK(joint.cost == Approx(magnetometer.cost + accelerometer.cost).epsilon(1e-10));
  for (const Fit* alone : {&magnetometer, &accelerometer}) {
    for (const sepcal::Parameter& parameter : alone->parameters) {
      const sepcal::Parameter& same = joint[parameter.name];
      INFO(parameter.name);
      CHECK(std::abs(same.value - parameter.value) < 1e-6 * parameter.standard_error);
      // s^2 allows for each fit's own number of parameters.
      CHECK(same.standard_error == Approx(parameter.standard_error).epsilon(0.01));
    }
  }
}

}  // namespace static_concatenation_test
