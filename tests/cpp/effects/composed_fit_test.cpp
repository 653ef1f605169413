// SPDX-License-Identifier: BSD-3-Clause
// Fits of composed models to records that were made without them: readings spoiled by hand. A case
// checks up to 16 estimates against 4 standard errors: one seed in a thousand would fail.
#include <doctest/doctest.h>

#include <cmath>

#include "composed_checks.hpp"
#include "sepcal/composition.hpp"
#include "sepcal/detail/effects/air_data.hpp"
#include "sepcal/detail/effects/magnetic.hpp"
#include "sepcal/detail/run_time_effect.hpp"
#include "sepcal/fit.hpp"

namespace composed_fit_test {

using Eigen::Index;
using sepcal::block_model;
using sepcal::compose;
using sepcal::Effect;
using sepcal::Fit;
using sepcal::Record;
using namespace sepcal::test;

namespace {

/// z with noise as the outputs of a model (rows of z output by output).
void add_noisy(Record& record, const sepcal::BlockModel& model, const Eigen::VectorXd& z,
               const Eigen::VectorXd& noise, Draws& draws) {
  const auto rows = static_cast<Index>(record.length());
  for (Index j = 0; j < noise.size(); ++j) {
    std::vector<double> column;
    for (Index k = 0; k < rows; ++k) {
      column.push_back(z[j * rows + k] + noise[j] * draws.normal());
    }
    record.add(model.tables().outputs[static_cast<std::size_t>(j)].name, std::move(column));
  }
}

void check_recovers(const Fit& fit, const NamedValues& truth) {
  CHECK(fit.status == sepcal::FitStatus::converged);
  REQUIRE(fit.parameters.size() == truth.size());
  for (const auto& [name, value] : truth) {
    CAPTURE(name);
    const sepcal::Parameter& found = fit[name];
    CHECK(found.standard_error > 0.0);
    CHECK(std::abs(found.value - value) < 4.0 * found.standard_error);
  }
}

}  // namespace

TEST_CASE("five-hole: shear, propwash and a heading bias, found alike at compile and at run time") {
  constexpr std::size_t rows = 900;
  const Simulated flight = simulate_five_hole(rows);
  Draws draws(461);
  NamedValues truth;
  const auto& tables = flight.model->tables();
  for (int k = 0; k < 5; ++k) {
    truth[tables.linear[static_cast<std::size_t>(k)].name] = flight.xi1[k];
    truth[tables.nonlinear[static_cast<std::size_t>(k)].name] = flight.xi2[k];
  }
  // What the air and the vehicle did; then what is logged of it.
  Record real;
  for (const auto& input : tables.inputs) {
    if (flight.record.has(input.name)) real.view(input.name, flight.record.column(input.name));
  }
  const std::vector<double> altitude = draws.uniform_column(rows, 250, 350);
  const std::vector<double> throttle = draws.uniform_column(rows, 0, 1);
  Eigen::VectorXd z = predict(*flight.model, real, truth);
  for (std::size_t k = 0; k < rows; ++k) {
    z[static_cast<Index>(k)] += 0.02 * (altitude[k] - 300);
    z[static_cast<Index>(k + rows)] -= 0.03 * (altitude[k] - 300);
  }
  auto logged = [&](const char* name) {
    const auto values = real.column(name);
    return std::vector<double>(values.begin(), values.end());
  };
  std::vector<double> yaw = logged("yaw");
  std::vector<double> pt = logged("pt");
  std::vector<double> dpa = logged("dpa");
  std::vector<double> dpb = logged("dpb");
  for (std::size_t k = 0; k < rows; ++k) {
    yaw[k] += 0.04;
    const double before = pt[k] - real.column("ps")[k];
    pt[k] -= 25.0 * throttle[k];  // the flow angles come out right from the pressures as read
    const double share = (pt[k] - real.column("ps")[k]) / before;
    dpa[k] *= share;
    dpb[k] *= share;
  }
  Record record = with_column(with_column(real, "yaw", yaw), "pt", pt);
  record = with_column(with_column(record, "dpa", dpa), "dpb", dpb);
  record.add("altitude_m", altitude).add("throttle", throttle);
  add_noisy(record, *flight.model, z, Eigen::Vector3d(0.1, 0.2, 0.3), draws);
  truth["wind[altitude_m].n"] = 0.02;
  truth["wind[altitude_m].e"] = -0.03;
  truth["pressure_offset[throttle].s"] = 25.0;
  truth["heading_bias.delta"] = 0.04;

  using namespace sepcal::effects;
  const sepcal::FiveHoleProbe host{4.5, 4.0, {0.35, -0.1, -0.02}};
  Effect wind{.name = "wind[altitude_m]"};
  wind.varying.push_back(
      {sepcal::power_driver({"altitude_m", "m"}, 300, 1), {{"n", "w_n"}, {"e", "w_e"}}, "m/s"});
  Effect wash{.name = "pressure_offset[throttle]"};
  wash.corrections.push_back(sepcal::driven_inputs(
      wash.name, sepcal::power_driver({"throttle", ""}, 0, 1),
      {{"s", sepcal::Variable(sepcal::port("pressure_offset", "Pa"))}}, "Pa", 60.0));
  const auto at_run_time = compose(
      block_model(host), {wash, wind, sepcal::effect("heading_bias", HeadingBias{})}, record);

  sepcal::FitOptions options;
  options.samples = 100;
  options.bounds["pressure_offset[throttle].s"] = {-60, 60};
  const Fit one = sepcal::fit(*at_run_time, record, options);
  check_recovers(one, truth);
  const Fit other =
      sepcal::fit(host + PressureOffset<"throttle">{} + HeadingBias{} + Wind<"altitude_m">{300},
                  record, options);
  check_recovers(other, truth);
  for (const auto& parameter : one.parameters) {
    CAPTURE(parameter.name);
    const auto& same = other[parameter.name];
    CHECK(std::abs(parameter.value - same.value) < 1e-6 * parameter.standard_error);
    CHECK(same.standard_error == doctest::Approx(parameter.standard_error).epsilon(1e-6));
  }
  CHECK(other.cost == doctest::Approx(one.cost).epsilon(1e-10));
}

TEST_CASE("magnetometer: a current's field, a temperature's scale and a late reading") {
  const std::vector<double> time = uneven_times(1500, 0.05);
  const Signals signals = magnetometer_signals();
  const sepcal::Magnetometer host;
  const auto model = block_model(host);
  NamedValues truth{{"lambda_x", 0.05}, {"lambda_y", -0.04}, {"lambda_z", 0.1},
                    {"n_x", 3},         {"n_y", -5},         {"n_z", 8},
                    {"eta_x", 0.02},    {"eta_y", -0.03},    {"eta_z", 0.04},
                    {"alpha_xy", 0.05}, {"alpha_xz", -0.02}, {"alpha_yz", 0.03}};
  Record record = sample(signals, time);
  const Record before = sample(signals, time, -0.12, {"hx", "hy", "hz"});
  Eigen::VectorXd z = predict(*model, before, truth);
  const Eigen::Vector3d per_ampere(0.3, -0.2, 0.5);
  const char* const field[] = {"hx", "hy", "hz"};
  for (Index j = 0; j < 3; ++j) {
    for (std::size_t k = 0; k < time.size(); ++k) {
      z[j * 1500 + static_cast<Index>(k)] +=
          per_ampere[j] * (record.column("current_a")[k] - 8.0) +
          1e-3 * (record.column("temp_degc")[k] - 40.0) * before.column(field[j])[k];
    }
  }
  Draws draws(462);
  add_noisy(record, *model, z, Eigen::Vector3d(0.1, 0.2, 0.15), draws);

  Effect bias{.name = "bias"};
  bias.varying.push_back({sepcal::power_driver({"current_a", "A"}, 8, 1),
                          {{"x", "n_x"}, {"y", "n_y"}, {"z", "n_z"}},
                          "uT per A"});
  Effect scale{.name = "scale"};
  scale.varying.push_back({sepcal::power_driver({"temp_degc", "degC"}, 40, 1),
                           {{"s", "", {{0, {"hx", "uT"}}, {1, {"hy", "uT"}}, {2, {"hz", "uT"}}}}},
                           "1"});
  Effect late{.name = "time_offset"};
  late.delays.push_back(
      {sepcal::Delay::Kind::outputs_late, {"time_offset.tau", "s", -0.5, 0.5}, {}});
  const std::vector<Effect> effects{bias, scale, late};
  truth.insert({{"bias.x", 0.3},
                {"bias.y", -0.2},
                {"bias.z", 0.5},
                {"scale.s", 1e-3},
                {"time_offset.tau", 0.12}});
  const auto composed = compose(model, effects, record);
  sepcal::FitOptions options;
  options.samples = 200;
  const Record inner = without_edges(record, sepcal::reach(effects));
  CHECK(inner.rows() < record.rows());
  check_recovers(sepcal::fit(*composed, inner, options), truth);
}

}  // namespace composed_fit_test
