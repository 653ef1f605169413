// SPDX-License-Identifier: BSD-3-Clause
// The simulator against facts from elsewhere: the equations written out by hand, numeric
// differences of its own attitude, tables of the standard atmosphere, laws of large numbers.
#include "sepcal/flight/simulate.hpp"

#include <doctest/doctest.h>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "sepcal/error.hpp"

namespace {

using namespace sepcal;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Names = std::array<const char*, 3>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

constexpr Names angles{"roll_rad", "pitch_rad", "yaw_rad"};
constexpr Names rates{"p_radps", "q_radps", "r_radps"};
constexpr Names velocity{"vn_mps", "ve_mps", "vd_mps"};
constexpr Names reading{"mx_ut", "my_ut", "mz_ut"};
constexpr Names earth_field{"bn_ut", "be_ut", "bd_ut"};

double at(const SimulatedFlight& flight, const char* name, std::size_t row) {
  return flight.column(name)[row];
}

Vector3d at(const SimulatedFlight& flight, const Names& names, std::size_t row) {
  return {at(flight, names[0], row), at(flight, names[1], row), at(flight, names[2], row)};
}

/// Eq. 39 entry by entry, with cos(psi) in entry (1,2).
Matrix3d body_to_ned(const SimulatedFlight& flight, std::size_t row) {
  const Vector3d euler = at(flight, angles, row);
  const Vector3d s = euler.array().sin(), c = euler.array().cos();
  const Vector3d north(c[1] * c[2], s[0] * s[1] * c[2] - c[0] * s[2],
                       c[0] * s[1] * c[2] + s[0] * s[2]);
  const Vector3d east(c[1] * s[2], s[0] * s[1] * s[2] + c[0] * c[2],
                      c[0] * s[1] * s[2] - s[0] * c[2]);
  const Vector3d down(-s[1], s[0] * c[1], c[0] * c[1]);
  return (Matrix3d() << north.transpose(), east.transpose(), down.transpose()).finished();
}

Matrix3d cross_matrix(const Vector3d& v) {
  return (Matrix3d() << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0).finished();
}

SimulationOptions condensed(std::size_t rows, std::uint64_t seed = 0) {
  return {.rate = 50.0, .rows = rows, .seed = seed};
}

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

/// The same truth without noise.
template <class Truth>
Truth quiet(Truth truth) {
  truth.noise = {0, 0, 0};
  return truth;
}

/// A magnetometer without noise and without errors.
MagnetometerTruth perfect_magnetometer() {
  MagnetometerTruth truth = quiet(MagnetometerTruth{});
  for (auto& [name, value] : truth.parameters) value = 0;
  return truth;
}

std::string text_of(const SimulatedFlight& flight) {
  std::ostringstream out;
  write_csv(flight, out);
  return out.str();
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

/// Largest minus smallest value, over the rows with this label.
double span_of(const SimulatedFlight& flight, const char* name, const std::string& label) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t k = 0; k < flight.rows(); ++k) {
    if (flight.maneuver[k] != label) continue;
    low = std::min(low, flight.column(name)[k]);
    high = std::max(high, flight.column(name)[k]);
  }
  return high - low;
}

/// Simulates with a truth or options that `spoil` has altered: refused in one line, with the
/// culprit and the way out in it.
template <class Truth, class Spoil>
void check_refused(SimulatedFlight (*simulate)(const Truth&, const SimulationOptions&),
                   const Spoil& spoil, const std::string& culprit, const std::string& way_out) {
  Truth truth;
  SimulationOptions options = condensed(20);
  spoil(truth, options);
  CAPTURE(culprit);
  try {
    simulate(truth, options);
    FAIL_CHECK("nothing was thrown");
  } catch (const Error& error) {
    const std::string what = error.what();
    CAPTURE(what);
    CHECK(what.find(culprit) != std::string::npos);
    CHECK(what.find(way_out) != std::string::npos);
    CHECK(what.find('\n') == std::string::npos);
  }
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

TEST_CASE("the same seed gives the same bytes, another seed other noise only") {
  const SimulatedFlight flight = simulate_five_hole({}, condensed(300, 7));
  const SimulatedFlight other = simulate_five_hole({}, condensed(300, 8));
  CHECK(text_of(flight) == text_of(simulate_five_hole({}, condensed(300, 7))));
  const std::set<std::string> noisy{"vn_mps", "ve_mps", "vd_mps"};
  for (const auto& column : flight.columns) {
    CAPTURE(column.name);
    CHECK((column.values != other.column(column.name)) == noisy.contains(column.name));
  }
  CHECK(text_of(simulate_magnetometer({}, condensed(300, 7))) ==
        text_of(simulate_magnetometer({}, condensed(300, 7))));
  CHECK(simulate_magnetometer({}, condensed(300, 7)).column("mx_ut") !=
        simulate_magnetometer({}, condensed(300, 8)).column("mx_ut"));
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

TEST_CASE("the full flight keeps the timetable of Table 5") {
  const SimulatedFlight flight = simulate_five_hole();
  const auto& time = flight.column("time_s");
  REQUIRE(flight.rows() == 37001);  // 740 s at 50 Hz, both ends
  CHECK(time.front() == 380.0);
  CHECK(time[1] == 380.02);
  CHECK(time.back() == 1120.0);
  std::map<std::string, std::pair<double, double>> seen;
  for (std::size_t k = 0; k < flight.rows(); ++k) {
    seen.try_emplace(flight.maneuver[k], time[k], time[k]).first->second.second = time[k];
  }
  seen.erase("cruise");
  // The yaw chirp's end, 1013.595 s, lies between two rows.
  const std::map<std::string, std::pair<double, double>> table{
      {"wind_circle_1", {384, 408.2}},  {"wind_circle_2", {411, 438.3}},
      {"popu", {510.9, 530}},           {"multisine_1", {576, 596}},
      {"multisine_2", {690, 711}},      {"multisine_3", {752, 772}},
      {"multisine_4", {810, 830}},      {"pitch_chirp_1", {867, 887}},
      {"yaw_chirp", {980.08, 1013.58}}, {"pitch_chirp_2", {1041, 1061}},
      {"rudder_doublet", {1113, 1115}}};
  CHECK(seen == table);
}

TEST_CASE("each maneuver excites what it is flown for, in the full and the condensed flight") {
  for (const std::size_t rows : {std::size_t{0}, std::size_t{400}}) {
    CAPTURE(rows);
    const SimulatedFlight flight = simulate_five_hole({}, condensed(rows));
    CHECK(flight.rows() == (rows == 0 ? 37001 : rows));
    for (const char* circle : {"wind_circle_1", "wind_circle_2"}) {
      std::set<int> octants;
      for (std::size_t k = 0; k < flight.rows(); ++k) {
        if (flight.maneuver[k] != circle) continue;
        octants.insert(static_cast<int>(std::floor(flight.column("yaw_rad")[k] / 0.7853981634)));
      }
      CHECK(octants.size() >= 8);
      CHECK(span_of(flight, "roll_rad", circle) > 0.3);
    }
    CHECK(span_of(flight, "pitch_rad", "popu") > 0.25);
    CHECK(span_of(flight, "p_radps", "multisine_1") > 0.5);
    CHECK(span_of(flight, "q_radps", "multisine_1") > 0.3);
    CHECK(span_of(flight, "r_radps", "multisine_1") > 0.3);
    CHECK(span_of(flight, "q_radps", "pitch_chirp_1") > 0.5);
    CHECK(span_of(flight, "r_radps", "yaw_chirp") > 0.5);
    CHECK(span_of(flight, "dpb_pa", "rudder_doublet") > 100.0);
    double slowest = 1e9, fastest = 0;
    for (std::size_t k = 0; k < flight.rows(); ++k) {
      const double impact = flight.column("pt_pa")[k] - flight.column("ps_pa")[k];
      REQUIRE(impact > 0);
      const double speed = std::sqrt(2 * impact / flight.column("rho_kgpm3")[k]);
      slowest = std::min(slowest, speed);
      fastest = std::max(fastest, speed);
    }
    CHECK(slowest > 10);
    CHECK(fastest < 25);
    CHECK(fastest - slowest > 6);
  }
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

TEST_CASE("the CSV has the columns of the interface and loses no bit") {
  const SimulatedFlight flight = simulate_five_hole({}, condensed(250, 3));
  std::istringstream lines(text_of(flight));
  std::string line;
  std::getline(lines, line);
  CHECK(line ==
        "time_s,roll_rad,pitch_rad,yaw_rad,p_radps,q_radps,r_radps,vn_mps,ve_mps,vd_mps,pt_pa,"
        "ps_pa,dpa_pa,dpb_pa,temp_k,rho_kgpm3,altitude_m,throttle,current_a,maneuver");
  std::size_t row = 0;
  for (; std::getline(lines, line); ++row) {
    std::istringstream cells(line);
    std::string cell;
    for (const auto& column : flight.columns) {
      std::getline(cells, cell, ',');
      REQUIRE(std::strtod(cell.c_str(), nullptr) == column.values[row]);
    }
    std::getline(cells, cell);
    REQUIRE(cell == flight.maneuver[row]);
  }
  CHECK(row == 250);

  const std::string magnetometer = text_of(simulate_magnetometer({}, condensed(2)));
  CHECK(magnetometer.substr(0, magnetometer.find('\n')) ==
        "time_s,mx_ut,my_ut,mz_ut,roll_rad,pitch_rad,yaw_rad,p_radps,q_radps,r_radps,bn_ut,be_ut,"
        "bd_ut,temp_degc,current_a,maneuver");
}

TEST_CASE("a failing stream is left failed") {
  std::ostream nowhere(nullptr);
  write_csv(simulate_five_hole({}, condensed(5)), nowhere);
  CHECK(nowhere.fail());
}

TEST_CASE("misuse is refused in one line with the way out") {
  const auto fly = [](auto spoil, const char* culprit, const char* way_out) {
    check_refused(simulate_five_hole, spoil, culprit, way_out);
  };
  fly([](auto& t, auto&) { t.parameters["lambda_v"] = 0; }, "'lambda_v' is unknown", "lambda_va");
  fly([](auto& t, auto&) { t.parameters.erase("w_e"); }, "'w_e' is missing", "w_n");
  fly([](auto& t, auto&) { t.parameters["b_va"] = not_a_number; }, "'b_va'", "finite");
  fly([](auto& t, auto&) { t.parameters["lambda_va"] = -1; }, "lambda_va = -1", "above -1");
  fly([](auto& t, auto&) { t.parameters["b_va"] = 40; }, "b_va = 40", "smaller");
  fly([](auto& t, auto&) { t.k_alpha = 0; }, "sensitivity 0 1/rad", "above 0");
  fly([](auto& t, auto&) { t.k_beta = not_a_number; }, "sensitivity nan 1/rad", "finite");
  fly([](auto& t, auto&) { t.noise[1] = -0.1; }, "velocity noise -0.1", "at least 0");
  fly([](auto& t, auto&) { t.lever_arm[2] = not_a_number; }, "lever arm nan", "finite");
  fly([](auto& t, auto&) { t.altitude = 12000; }, "12000 m", "11000 m");
  fly([](auto&, auto& o) { o.rate = 0; }, "rate: 0 Hz", "at most 10000");
  fly([](auto&, auto& o) { o.rate = not_a_number; }, "rate: nan Hz", "at most 10000");
  fly([](auto&, auto& o) { o.rows = 20'000'000; }, "20000000", "at most 10000000");

  const auto turn = [](auto spoil, const char* culprit, const char* way_out) {
    check_refused(simulate_magnetometer, spoil, culprit, way_out);
  };
  turn([](auto& t, auto&) { t.noise[0] = -1; }, "magnetometer noise -1", "at least 0");
  turn([](auto& t, auto&) { t.field[1] = not_a_number; }, "field nan", "finite");
  turn([](auto& t, auto&) { t.parameters["eta"] = 0; }, "'eta' is unknown", "eta_x");
}

TEST_CASE("a column that is not there is named, with those that are") {
  const SimulatedFlight flight = simulate_five_hole({}, condensed(2));
  CHECK_THROWS_WITH_AS(flight.column("vn"), doctest::Contains("'vn' is missing; it has: time_s, "),
                       Error);
}
