// SPDX-License-Identifier: BSD-3-Clause
// The simulator's physics against facts from elsewhere: the equations written out by hand, numeric
// differences of its own attitude, tables of the standard atmosphere, laws of large numbers.
#include "sepcal/simulation/simulate.hpp"

#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "numerics/decompositions.hpp"
#include "simulated_flights.hpp"

namespace simulate_test {

namespace {

using namespace sepcal;
using namespace sepcal::test;

/// Eqs. 36-41 by hand: the ground velocity that follows from one row of pressures.
Vector3d ground_velocity(const SimulatedFlight& flight, std::size_t row,
                         const FiveHoleTruth& truth) {
  const auto x = [&](const char* name) { return truth.parameters.at(name); };
  const double impact = at(flight, "pt_pa", row) - at(flight, "ps_pa", row);
  const double read = std::sqrt(2 * impact / at(flight, "rho_kgpm3", row));
  const double read_alpha = at(flight, "dpa_pa", row) / (truth.k_alpha * impact);
  const double read_beta = at(flight, "dpb_pa", row) / (truth.k_beta * impact);
  const double alpha = (1 + x("lambda_alpha")) * read_alpha + x("b_alpha");
  const double beta = (1 + x("lambda_beta")) * read_beta + x("b_beta");
  const double c = std::cos(x("eps_phi")), s = std::sin(x("eps_phi"));
  const Matrix3d probe_to_body = (Matrix3d() << 1, 0, 0, 0, c, s, 0, -s, c).finished();
  const Vector3d met(std::cos(alpha) * std::cos(beta), std::sin(beta),
                     std::sin(alpha) * std::cos(beta));
  const Vector3d body = probe_to_body * ((1 + x("lambda_va")) * read + x("b_va")) * met -
                        cross_matrix(at(flight, rates, row)) * Vector3d(truth.lever_arm.data());
  return body_to_ned(flight, row) * body + Vector3d(x("w_n"), x("w_e"), x("w_d"));
}

FiveHoleTruth other_five_hole() {
  FiveHoleTruth truth;
  truth.parameters = {{"lambda_va", -0.1}, {"b_va", -1.1},    {"w_n", 5.0},
                      {"w_e", -2.0},       {"w_d", -0.7},     {"lambda_alpha", 0.3},
                      {"b_alpha", 0.06},   {"b_beta", -0.05}, {"lambda_beta", -0.25},
                      {"eps_phi", -0.2}};
  truth.k_alpha = 6.5;
  truth.k_beta = 5.5;
  truth.lever_arm = {0.8, -0.3, 0.2};
  return truth;
}

/// A magnetometer without noise and without errors.
MagnetometerTruth perfect_magnetometer() {
  MagnetometerTruth truth = quiet(MagnetometerTruth{});
  for (auto& [name, value] : truth.parameters) value = 0;
  return truth;
}

/// White and Gaussian with these standard deviations: moments one to four, and the correlation with
/// the previous row and the next column. Each bound is 4.5 standard errors of its statistic: a good
/// generator fails one with probability 7e-6, all 21 of them with 2e-4.
void check_noise(const SimulatedFlight& noisy, const SimulatedFlight& clean, const Names& names,
                 const std::array<double, 3>& sigma) {
  const auto rows = static_cast<Eigen::Index>(noisy.rows());
  const double bound = 4.5 / std::sqrt(static_cast<double>(rows));
  const auto values = [&](const SimulatedFlight& flight, std::size_t j) {
    return Eigen::Map<const Eigen::ArrayXd>(flight.column(names[j]).data(), rows);
  };
  Eigen::ArrayXXd e(rows, 3);
  for (std::size_t j = 0; j < 3; ++j) {
    e.col(static_cast<Eigen::Index>(j)) = (values(noisy, j) - values(clean, j)) / sigma[j];
  }
  for (Eigen::Index j = 0; j < 3; ++j) {
    const Eigen::ArrayXd own = e.col(j), next = e.col((j + 1) % 3);
    CHECK(std::abs(own.mean()) < bound);
    CHECK(std::abs(own.square().mean() - 1) < bound * std::sqrt(2.0));
    CHECK(std::abs(own.cube().mean()) < bound * std::sqrt(15.0));
    CHECK(std::abs(own.square().square().mean() - 3) < bound * std::sqrt(96.0));
    CHECK(std::abs((own * next).mean()) < bound);
    CHECK(std::abs((own.tail(rows - 1) * own.head(rows - 1)).mean()) < bound);
    CHECK(std::abs((own.tail(rows - 1) * next.head(rows - 1)).mean()) < bound);
  }
}

/// C(t - h)' C(t + h) = I + 2h [w x] + O(h^3 w''), and the attitude is all that enters.
/// With 120,000 rows h is at most 1 ms and w'' at most 100 rad/s^3: 2e-5 rad/s.
void check_rates(const SimulatedFlight& flight) {
  double worst = 0;
  for (std::size_t k = 1; k + 1 < flight.rows(); k += 7) {
    const Matrix3d turned = body_to_ned(flight, k - 1).transpose() * body_to_ned(flight, k + 1);
    const double span = at(flight, "time_s", k + 1) - at(flight, "time_s", k - 1);
    const Matrix3d turning = (turned - turned.transpose()) / (2 * span);
    worst = std::max(worst, (turning - cross_matrix(at(flight, rates, k))).cwiseAbs().maxCoeff());
  }
  CHECK(worst < 5e-5);
}

}  // namespace

TEST_CASE("the wind triangle closes, whatever the truth and the plan") {
  for (const FiveHoleTruth& truth : {quiet(FiveHoleTruth{}), quiet(other_five_hole())}) {
    for (const SimulatedFlight& flight :
         {simulate_five_hole(truth, {.rate = 10.0}), simulate_five_hole(truth, condensed(400))}) {
      CHECK(flight.truth == truth.parameters);
      double worst = 0;
      for (std::size_t k = 0; k < flight.rows(); ++k) {
        const Vector3d expected = ground_velocity(flight, k, truth);
        worst = std::max(worst, (at(flight, velocity, k) - expected).norm());
      }
      CHECK(worst < 1e-10);  // rounding: 25 m/s through pt - ps, known to 1e-11 Pa of 100 Pa
    }
  }
}

TEST_CASE("body rates are the derivative of the attitude") {
  check_rates(simulate_five_hole({}, condensed(120000)));
  check_rates(simulate_magnetometer({}, condensed(120000)));
}

TEST_CASE("the air is the standard atmosphere's") {
  // ISO 2533 at geopotential altitudes: temperature [K], pressure [Pa], density [kg/m^3].
  struct Level {
    double altitude, temperature, pressure, density;
  };
  for (const Level& level :
       {Level{0, 288.15, 101325, 1.2250}, Level{1000, 281.65, 89874.6, 1.11164},
        Level{5000, 255.65, 54019.9, 0.736116}}) {
    FiveHoleTruth truth;
    truth.altitude = level.altitude;
    const SimulatedFlight flight = simulate_five_hole(truth, condensed(1));
    CHECK(flight.column("altitude_m")[0] == level.altitude);
    CHECK(flight.column("temp_k")[0] == doctest::Approx(level.temperature).epsilon(1e-12));
    CHECK(flight.column("ps_pa")[0] == doctest::Approx(level.pressure).epsilon(1e-6));
    CHECK(flight.column("rho_kgpm3")[0] == doctest::Approx(level.density).epsilon(4e-6));
  }
}

TEST_CASE("altitude and static pressure follow the flight") {
  const SimulatedFlight flight = simulate_five_hole(quiet(FiveHoleTruth{}));
  const auto& altitude = flight.column("altitude_m");
  const auto& pressure = flight.column("ps_pa");
  double climbed = 0, worst_balance = 0;
  for (std::size_t k = 2; k < flight.rows(); k += 2) {  // Simpson's rule over two intervals
    const auto& vd = flight.column("vd_mps");
    climbed -= 0.02 / 3 * (vd[k - 2] + 4 * vd[k - 1] + vd[k]);
    // Hydrostatic balance: dp = -rho g dh.
    const double weight =
        9.80665 * flight.column("rho_kgpm3")[k - 1] * (altitude[k] - altitude[k - 2]);
    worst_balance = std::max(worst_balance, std::abs(pressure[k] - pressure[k - 2] + weight));
  }
  CHECK(altitude.back() - altitude.front() == doctest::Approx(climbed).epsilon(1e-4));
  CHECK(worst_balance < 1e-6);
}

TEST_CASE("the magnetometer reads the field through its errors") {
  for (MagnetometerTruth truth : {quiet(MagnetometerTruth{}), perfect_magnetometer()}) {
    truth.field = {17.0, 3.0, -45.0};
    const auto x = [&](const char* name) { return truth.parameters.at(name); };
    const double axy = x("alpha_xy"), axz = x("alpha_xz"), ayz = x("alpha_yz");
    Matrix3d soft_iron;
    soft_iron << 1, axy, axz, axy, 1, ayz, axz, ayz, 1;
    const Matrix3d misalignment =  // Eq. A2 with eta_x in entry (3,2)
        Matrix3d::Identity() + cross_matrix({x("eta_x"), x("eta_y"), x("eta_z")});
    const Vector3d scale(1 + x("lambda_x"), 1 + x("lambda_y"), 1 + x("lambda_z"));
    const Vector3d bias(x("n_x"), x("n_y"), x("n_z"));
    const Vector3d field(truth.field.data());
    const SimulatedFlight flight = simulate_magnetometer(truth, condensed(400));
    CHECK(flight.truth == truth.parameters);
    double worst = 0;
    for (std::size_t k = 0; k < flight.rows(); ++k) {
      const Vector3d h = body_to_ned(flight, k).transpose() * field;
      const Vector3d expected = soft_iron * misalignment * scale.cwiseProduct(h) + bias;
      worst = std::max(worst, (at(flight, reading, k) - expected).norm());
      REQUIRE(at(flight, earth_field, k) == field);
    }
    CHECK(worst < 1e-12);  // rounding of 50 uT
  }
}

TEST_CASE("the magnetometer sees the whole sphere") {
  for (const std::size_t rows : {std::size_t{0}, std::size_t{300}}) {
    const SimulatedFlight flight = simulate_magnetometer(perfect_magnetometer(), condensed(rows));
    CHECK(flight.rows() == (rows == 0 ? 16001 : rows));
    const std::set<std::string> labels(flight.maneuver.begin(), flight.maneuver.end());
    CHECK(labels == std::set<std::string>{"figure_eight", "bank", "pitch", "tumble"});
    // Every one of the 26 directions of a cube's faces, edges and corners within 30 degrees.
    for (int direction = 0; direction < 27; ++direction) {
      const Vector3d d(direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1);
      if (d.isZero()) continue;
      double nearest = -1;
      for (std::size_t k = 0; k < flight.rows(); ++k) {
        nearest = std::max(nearest, d.normalized().dot(at(flight, reading, k).normalized()));
      }
      CAPTURE(direction);
      CHECK(nearest > 0.866);
    }
  }
}

TEST_CASE("the noise is white and Gaussian with the standard deviations asked for") {
  FiveHoleTruth probe;
  probe.noise = {0.1, 0.2, 0.3};
  check_noise(simulate_five_hole(probe, {.seed = 1}), simulate_five_hole(quiet(probe)), velocity,
              probe.noise);
  MagnetometerTruth magnetometer;
  magnetometer.noise = {0.2, 0.4, 0.8};
  check_noise(simulate_magnetometer(magnetometer, {.seed = 2}),
              simulate_magnetometer(quiet(magnetometer)), reading, magnetometer.noise);
}

}  // namespace simulate_test
