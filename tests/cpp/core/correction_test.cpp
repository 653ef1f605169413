// SPDX-License-Identifier: BSD-3-Clause
// Corrections on board, each with three effects: what a sensor reads of a truth is written down
// here once more, and the correction has to give the truth back.
#include "sepcal/detail/correction.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "draws.hpp"
#include "sepcal/detail/effects/air_data.hpp"
#include "sepcal/detail/effects/magnetic.hpp"

namespace correction_test {

using doctest::Approx;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using sepcal::Calibrated;
using sepcal::CorrectionStatus;
using sepcal::Sizes;
using sepcal::Vec;
using sepcal::test::Draws;
namespace effects = sepcal::effects;

namespace {

/// Parameters by their names: corrections' stand in another order than they were added in.
template <class M>
Calibrated<M> with(const M& model,
                   std::initializer_list<std::pair<const char*, double>> parameters) {
  Calibrated<M> board{model};
  for (const auto& [name, value] : parameters) CHECK(board.set(name, value));
  CHECK(board.xi1.allFinite());
  CHECK(board.xi2.allFinite());
  return board;
}

/// An input by its name.
template <class M>
double& input(Vec<double, Sizes<M>::n_u>& u, std::string_view name) {
  return u[sepcal::place_of(name, M::inputs)];
}

template <class M>
auto calibrated(const M& model, Vec<double, Sizes<M>::n_1> xi1, Vec<double, Sizes<M>::n_2> xi2) {
  return Calibrated<M>{model, xi1, xi2};
}

template <class M>
Calibrated<M, float> in_float(const Calibrated<M>& calibrated) {
  return {calibrated.model, calibrated.xi1.template cast<float>(),
          calibrated.xi2.template cast<float>()};
}

}  // namespace

TEST_CASE("a magnetometer with a current, a temperature and a curved response") {
  const auto model = sepcal::Magnetometer{} + effects::Bias<"current_a">{.centre = 4.0} +
                     effects::AxisScale<"temp_degc">{.centre = 25.0} + effects::CubicNonlinearity{};
  using M = std::remove_const_t<decltype(model)>;
  Vec<double, Sizes<M>::n_1> xi1;
  xi1 << 0.1, -0.05, 0.02, 3.0, -7.0, 12.0,  // lambda, n
      0.8, -0.4, 1.1,                        // bias[current_a]
      1e-3, -2e-3, 5e-4,                     // axis_scale[temp_degc]
      2e-6, -3e-6, 1e-6, 4e-5, -2e-5, 3e-5;  // cubic
  Vec<double, 6> xi2{{0.02, -0.03, 0.05, 0.04, -0.02, 0.01}};
  const auto board = calibrated(model, xi1, xi2);
  Draws draws(1);
  int worst = 0;
  for (int k = 0; k < 200; ++k) {
    const Vector3d h = 50.0 * Vector3d(draws.normal(), draws.normal(), draws.normal()).normalized();
    const double current = draws.uniform(0.0, 30.0);
    const double temperature = draws.uniform(-10.0, 60.0);
    Matrix3d C_alpha;
    C_alpha << 1, 0.04, -0.02, 0.04, 1, 0.01, -0.02, 0.01, 1;
    Matrix3d C_eta;
    C_eta << 1, -0.05, -0.03, 0.05, 1, -0.02, 0.03, 0.02, 1;
    const Vector3d scale = Vector3d(1.1, 0.95, 1.02);
    const Vector3d reading = C_alpha * C_eta * scale.asDiagonal() * h + Vector3d(3, -7, 12) +
                             (current - 4.0) * Vector3d(0.8, -0.4, 1.1) +
                             (temperature - 25.0) * Vector3d(1e-3, -2e-3, 5e-4).cwiseProduct(h) +
                             Vector3d(2e-6, -3e-6, 1e-6).cwiseProduct(Vector3d(h.array().cube())) +
                             Vector3d(4e-5, -2e-5, 3e-5).cwiseProduct(Vector3d(h.array().square()));
    const Vec<double, 5> u{{0, 0, 0, current, temperature}};
    const auto corrected = sepcal::correct(board, reading, u);
    REQUIRE(corrected.status == CorrectionStatus::ok);
    CHECK((corrected.h - h).norm() < 1e-12 * 50.0);
    worst = std::max(worst, corrected.iterations);
    const auto coarse = sepcal::correct(in_float(board), Vec<float, 3>(reading.cast<float>()),
                                        Vec<float, 5>(u.cast<float>()));
    CHECK(coarse.status == CorrectionStatus::ok);
    CHECK((coarse.h.cast<double>() - h).norm() < 4e-6 * 50.0);
  }
  CHECK(worst <= 5);
  const Vec<double, 5> unknown{{0, 0, 0, sepcal::not_a_number, 20}};
  const auto refused = sepcal::correct(board, Vector3d(1, 2, 3), unknown);
  CHECK(refused.status == CorrectionStatus::refused);
  CHECK(refused.h.array().isNaN().all());
  // No field makes a saturated cubic read a thousand times the Earth's.
  const auto lost =
      sepcal::correct(board, Vector3d(5e4, -5e4, 5e4), Vec<double, 5>{{0, 0, 0, 5, 20}});
  CHECK(lost.iterations <= 20);
}

TEST_CASE("what turns the reference is no part of a magnetometer's correction") {
  const auto plain = sepcal::Magnetometer{} + effects::Bias<"current_a">{};
  const auto turned = plain + effects::AttitudeBias{};
  const Vec<double, 9> xi1{{0.1, 0.0, 0.0, 1.0, 2.0, 3.0, 0.5, 0.6, 0.7}};
  const Vec<double, 6> xi2 = Vec<double, 6>::Constant(0.01);
  Vec<double, 8> more;
  more << xi2, 0.1, 0.1;
  const Vec<double, 4> u{{0, 0, 0, 2.0}};
  CHECK(sepcal::correct(calibrated(plain, xi1, xi2), Vector3d(20, 5, 40), u).h ==
        sepcal::correct(calibrated(turned, xi1, more), Vector3d(20, 5, 40), u).h);
}

TEST_CASE("a magnetometer by strength with a current, a temperature and a supply") {
  const auto model = sepcal::AttitudeIndependentMagnetometer{48.0} +
                     effects::strength::Bias<"current_a">{.centre = 2.0} +
                     effects::strength::Scale<"temp_degc">{.centre = 20.0} +
                     effects::strength::AxisScale<"voltage_v">{.centre = 12.0};
  using M = std::remove_const_t<decltype(model)>;
  const auto board = with(model, {{"lambda_x", 0.1},
                                  {"lambda_y", -0.05},
                                  {"lambda_z", 0.02},
                                  {"alpha_xy", 0.04},
                                  {"alpha_xz", -0.02},
                                  {"alpha_yz", 0.01},
                                  {"n_x", 3.0},
                                  {"n_y", -7.0},
                                  {"n_z", 12.0},
                                  {"bias[current_a].x", 0.8},
                                  {"bias[current_a].y", -0.4},
                                  {"bias[current_a].z", 1.1},
                                  {"scale[temp_degc].s", 1e-3},
                                  {"axis_scale[voltage_v].x", 2e-3},
                                  {"axis_scale[voltage_v].y", -1e-3},
                                  {"axis_scale[voltage_v].z", 5e-4}});
  Draws draws(2);
  for (int k = 0; k < 200; ++k) {
    const Vector3d h = 48.0 * Vector3d(draws.normal(), draws.normal(), draws.normal()).normalized();
    const double current = draws.uniform(0.0, 30.0);
    const double temperature = draws.uniform(-10.0, 60.0);
    const double voltage = draws.uniform(10.0, 12.6);
    Matrix3d C;
    C << 1, 0.04, -0.02, 0.04, 1, 0.01, -0.02, 0.01, 1;
    C = C * Vector3d(1.1, 0.95, 1.02).asDiagonal();
    C.diagonal() += (voltage - 12.0) * Vector3d(2e-3, -1e-3, 5e-4) +
                    (temperature - 20.0) * Vector3d::Constant(1e-3);
    const Vector3d m = C * h + Vector3d(3, -7, 12) + (current - 2.0) * Vector3d(0.8, -0.4, 1.1);
    Vec<double, 11> u = Vec<double, 11>::Zero();
    u.head<3>() = m;
    input<M>(u, "current_a") = current;
    input<M>(u, "temp_degc") = temperature;
    input<M>(u, "voltage_v") = voltage;
    const auto corrected = sepcal::correct(board, u);
    REQUIRE(corrected.status == CorrectionStatus::ok);
    CHECK((corrected.h - h).norm() < 1e-12 * 48.0);
    CHECK((sepcal::correct(in_float(board), Vec<float, 11>(u.cast<float>())).h.cast<double>() - h)
              .norm() < 4e-6 * 48.0);
  }
}

TEST_CASE("a five-hole probe with a pressure's offset, a scale and a vane that follow drivers") {
  const auto model = sepcal::FiveHoleProbe{4.5, 4.2, {0.3, 0.1, 0.0}} +
                     effects::Wind<"altitude_m">{.centre = 500.0} +
                     effects::AirspeedScale<"temp_degc">{.centre = 20.0} +
                     effects::PressureOffset<"current_a">{} + effects::AlphaOffset<"flaps">{} +
                     effects::HeadingBias{};
  using M = std::remove_const_t<decltype(model)>;
  const auto board = with(model, {{"lambda_va", 0.05},
                                  {"b_va", -0.3},
                                  {"w_n", 4.0},
                                  {"w_e", -2.0},
                                  {"w_d", 0.1},
                                  {"wind[altitude_m].n", 0.01},
                                  {"wind[altitude_m].e", 0.02},
                                  {"airspeed_scale[temp_degc].s", 2e-3},
                                  {"lambda_alpha", 0.1},
                                  {"b_alpha", 0.02},
                                  {"lambda_beta", -0.1},
                                  {"b_beta", 0.03},
                                  {"eps_phi", 0.1},
                                  {"pressure_offset[current_a].s", 1.5},
                                  {"alpha_offset[flaps].s", 0.2},
                                  {"heading_bias.delta", 0.05}});
  Draws draws(3);
  for (int k = 0; k < 200; ++k) {
    const double speed = draws.uniform(12.0, 40.0);
    const double alpha = draws.uniform(-0.2, 0.3);  // in the probe's axes
    const double beta = draws.uniform(-0.2, 0.2);
    const double temperature = draws.uniform(-10, 50);
    const double current = draws.uniform(0, 20);
    const double flaps = draws.uniform(0, 0.5);
    const double rho = draws.uniform(0.9, 1.25);
    // speed = (1 + lambda + s (T - 20)) v + b, v = sqrt(2 (dp + s I) / rho)
    const double v = (speed + 0.3) / (1.05 + 2e-3 * (temperature - 20.0));
    const double dp = 0.5 * rho * v * v - 1.5 * current;
    const double alpha_read = (alpha - 0.02) / 1.1 - 0.2 * flaps;
    const double beta_read = (beta - 0.03) / 0.9;
    using Inputs = Vec<double, Sizes<M>::n_u>;
    Inputs u = Inputs::Zero();
    const auto put = [&u](std::string_view name, double value) { input<M>(u, name) = value; };
    put("roll", draws.normal());
    put("yaw", draws.normal());
    put("q", draws.normal());
    put("pt", 9e4 + dp);
    put("ps", 9e4);
    put("dpa", alpha_read * 4.5 * dp);
    put("dpb", beta_read * 4.2 * dp);
    put("rho", rho);
    put("altitude_m", 700.0);
    put("temp_degc", temperature);
    put("current_a", current);
    put("flaps", flaps);
    const auto air = sepcal::correct(board, u);
    REQUIRE(air.status == CorrectionStatus::ok);
    // The probe is turned by eps = 0.1 about x.
    const Vector3d in_probe(std::cos(alpha) * std::cos(beta), std::sin(beta),
                            std::sin(alpha) * std::cos(beta));
    const Vector3d in_body(in_probe[0], std::cos(0.1) * in_probe[1] + std::sin(0.1) * in_probe[2],
                           std::cos(0.1) * in_probe[2] - std::sin(0.1) * in_probe[1]);
    CHECK(air.airspeed == Approx(speed).epsilon(1e-12));
    CHECK(std::abs(air.alpha - std::atan2(in_body[2], in_body[0])) < 1e-12);
    CHECK(std::abs(air.beta - std::asin(in_body[1])) < 1e-12);
    const auto coarse = sepcal::correct(in_float(board), u.cast<float>().eval());
    CHECK(std::abs(static_cast<double>(coarse.airspeed) - speed) < 5e-4 * speed);
  }
  using Inputs = Vec<double, Sizes<M>::n_u>;
  CHECK(sepcal::correct(board, Inputs::Zero().eval()).status == CorrectionStatus::refused);
}

TEST_CASE("a Pitot-static tube with an offset of its pressure, a scale and a bias") {
  const auto model = sepcal::PitotStatic{} + effects::tube::AirspeedScale<"alpha">{} +
                     effects::tube::AirspeedBias<"temp_degc">{.centre = 15.0} +
                     effects::PressureOffset<"current_a">{};
  using M = std::remove_const_t<decltype(model)>;
  const auto board = with(model, {{"s_va", 0.97},
                                  {"c_va", 0.4},
                                  {"w_n", 3.0},
                                  {"w_e", -1.0},
                                  {"w_d", 0.0},
                                  {"airspeed_scale[alpha].s", 0.2},
                                  {"airspeed_bias[temp_degc].s", 0.01},
                                  {"pressure_offset[current_a].s", 2.0}});
  Draws draws(4);
  for (int k = 0; k < 200; ++k) {
    const double V = draws.uniform(10.0, 60.0);
    const double alpha = draws.uniform(-0.2, 0.3);
    const double temperature = draws.uniform(-10.0, 50.0);
    const double current = draws.uniform(0.0, 10.0);
    const double rho = draws.uniform(0.9, 1.25);
    const double undisturbed = (V - 0.01 * (temperature - 15.0)) / (1.0 + 0.2 * alpha);
    const double met = std::sqrt(undisturbed * undisturbed - 2.0 * 2.0 * current / rho);
    using Inputs = Vec<double, Sizes<M>::n_u>;
    Inputs u = Inputs::Zero();
    input<M>(u, "rho") = rho;
    input<M>(u, "alpha") = alpha;
    input<M>(u, "temp_degc") = temperature;
    input<M>(u, "current_a") = current;
    const auto corrected = sepcal::correct(board, 0.97 * met + 0.4, u);
    REQUIRE(corrected.status == CorrectionStatus::ok);
    CHECK(corrected.airspeed == Approx(V).epsilon(1e-12));
    CHECK(static_cast<double>(sepcal::correct(in_float(board), static_cast<float>(0.97 * met + 0.4),
                                              u.cast<float>().eval())
                                  .airspeed) == Approx(V).epsilon(1e-5));
  }
}

TEST_CASE("an angle or a rate may drive an effect, and a bias may leave no airspeed") {
  const auto model = sepcal::FiveHoleProbe{4.5, 4.5} + effects::AirspeedScale<"pitch">{} +
                     effects::AirspeedBias<"q">{.centre = 0.5} + effects::LeverArm{};
  const auto board = with(model, {{"lambda_va", 0.0},
                                  {"b_va", -5.0},
                                  {"w_n", 4.0},
                                  {"w_e", -2.0},
                                  {"w_d", 0.1},
                                  {"airspeed_scale[pitch].s", 0.5},
                                  {"airspeed_bias[q].s", 3.0},
                                  {"lever_arm.x", 2.0},
                                  {"lever_arm.y", 1.0},
                                  {"lever_arm.z", 3.0},
                                  {"lambda_alpha", 0.0},
                                  {"b_alpha", 0.1},
                                  {"lambda_beta", 0.0},
                                  {"b_beta", 0.0},
                                  {"eps_phi", 0.0}});
  Vec<double, 14> u = Vec<double, 14>::Zero();
  u << 0.2, 0.3, 1.0, 0.1, 0.7, 0.2, 1250.0, 1000.0, 0.0, 0.0, 1.25, 0, 0, 0;  // reads 20 m/s
  CHECK(sepcal::correct(board, u).airspeed == Approx(20.0 * (1.0 + 0.5 * 0.3) - 5.0 + 3.0 * 0.2));
  CHECK(sepcal::correct(board, u).alpha == Approx(0.1));
  u[6] = 1001.0;
  const double read = std::sqrt(2.0 / 1.25);
  CHECK(sepcal::correct(board, u).airspeed == Approx(read * 1.15 - 5.0 + 0.6));  // below zero
  CHECK(sepcal::correct(board, u).alpha == Approx(0.1));
  u[6] = 990.0;
  CHECK(sepcal::correct(board, u).status == CorrectionStatus::refused);
}

/// A driver that is logged 4 A too low.
struct MeterOffset {
  static constexpr int corrected = 1;
  static constexpr std::array inputs{sepcal::Quantity{"current_a", ""}};
  static constexpr std::array nonlinear{sepcal::Quantity{"meter.zero", "A", -9, 9}};
  template <class T>
  Vec<T, 1> correct(const Vec<T, 1>& u, const Vec<T, 1>& xi2) const {
    return u + xi2;
  }
};

TEST_CASE("a driver that is corrected drives a magnetometer's effect as corrected") {
  const auto model = sepcal::Magnetometer{} + effects::Bias<"current_a">{} + MeterOffset{};
  auto board =
      calibrated(model, Vec<double, 9>{{0, 0, 0, 0, 0, 0, 0.5, 0, 0}}, Vec<double, 7>::Zero());
  CHECK(board.set("meter.zero", 4.0));
  const auto corrected =
      sepcal::correct(board, Vector3d(22.0, 0.0, 40.0), Vec<double, 4>{{0, 0, 0, 0}});
  CHECK(corrected.h[0] == Approx(20.0));
}

TEST_CASE("a plain tube reads no density") {
  const auto board = with(sepcal::PitotStatic{},
                          {{"s_va", 1.1}, {"c_va", 0.5}, {"w_n", 0.0}, {"w_e", 0.0}, {"w_d", 0.0}});
  CHECK(sepcal::correct(board, 22.5, Vec<double, 7>::Zero().eval()).airspeed == Approx(20.0));
}

TEST_CASE("a parameter that is not set is refused, and one that there isn't is told") {
  Calibrated<sepcal::Magnetometer> board{};
  CHECK(board.set("n_x", 1.0));
  CHECK_FALSE(board.set("n_w", 1.0));
  const Vector3d h = Vector3d::Zero();
  CHECK(sepcal::correct(board, Vector3d(20, 5, 40), h).status == CorrectionStatus::refused);
}

}  // namespace correction_test
