// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/flow_angle_rows.hpp"

#include <cmath>

#include "flight/catalogue/effect_makers.hpp"
#include "sepcal/detail/effects/air_data.hpp"
#include "sepcal/detail/run_time_effect.hpp"

namespace sepcal::catalogue {
namespace {

constexpr double largest_angle = 0.35;           // [rad] of an offset
constexpr double most_compressible = 3.0;        // of what air is
constexpr double most_loss = 5.0;                // per square of a sine
constexpr Interval near_the_probe{-10.0, 10.0};  // [m] of the probe from where it is said to be

/// An offset by k times a rate over the airspeed as read [rad/m].
EffectKit::Maker by_rate(Port port, const std::string& rate, AirspeedColumn name_airspeed) {
  port.components.front().name = std::string("k");
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    const auto airspeed = record.column(name_airspeed(record));
    const auto rates = record.column(rate);
    const std::string name = rate + " / airspeed";
    derive(record, name, [&](std::size_t row) { return rates[row] / airspeed[row]; });
    return make_driven(setting.name, port, power_driver({name, "rad/m"}, 0.0, 1), "m", model,
                       record);
  };
}

/// The airspeed of compressible air over that of incompressible air, less one: with
/// M^2 = 5 [(q/ps + 1)^(2/7) - 1], q the impact pressure, and the speed of sound sqrt(1.4 ps /
/// rho). In the plain tube the pressures are the noisy measurement itself, which would bias the
/// coefficient.
EffectKit::Maker compressible(const Port& airspeed_scale, ImpactPressure impact) {
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    const auto pressure = impact(record);
    const auto ps = record.column("ps");
    const auto rho = record.column("rho");
    derive(record, "compressible share", [&](std::size_t row) {
      const double q = pressure(row);
      const double mach = std::sqrt(5.0 * (std::pow(q / ps[row] + 1.0, 2.0 / 7.0) - 1.0));
      return std::sqrt(1.4 * ps[row] / rho[row]) * mach / std::sqrt(2.0 * q / rho[row]) - 1.0;
    });
    return make_driven(setting.name, airspeed_scale,
                       power_driver({"compressible share", "1"}, 0.0, 1), "1", model, record);
  };
}

EffectKit::Maker angle_loss(const Port& airspeed_scale, double (*lost)(double, double)) {
  return [=](const BlockModel& model, EffectSetting& setting, Record& record) {
    const auto alpha = record.column("alpha");
    const auto beta = record.column("beta");
    const std::string name = "sin^2 of the flow's angle";
    derive(record, name, [&](std::size_t row) { return lost(alpha[row], beta[row]); });
    return make_driven(setting.name, airspeed_scale, power_driver({name, "1"}, 0.0, 1), "1", model,
                       record);
  };
}

}  // namespace

void derive(Record& record, const std::string& name,
            const std::function<double(std::size_t row)>& value) {
  if (record.has(name)) return;
  std::vector<double> column(record.length());
  for (std::size_t row = 0; row < column.size(); ++row) column[row] = value(row);
  record.add(name, std::move(column));
}

FlowPorts flow_ports() {
  // Each by itself: where memory runs out within nested braces, g++ 12 destroys what never was.
  FlowPorts ports;
  ports.airspeed_scale = {
      "airspeed_scale", "1", {{.name = "s", .linear = "lambda_va"}}, largest_scale};
  ports.airspeed_bias = {"airspeed_bias", "m/s", {{.name = "s", .linear = "b_va"}}, largest_speed};
  ports.alpha_offset = on_input("alpha_offset", "rad", largest_angle);
  ports.beta_offset = on_input("beta_offset", "rad", largest_angle);
  return ports;
}

std::vector<PortRow> flow_port_rows(const FlowPorts& ports,
                                    const std::vector<Form>& of_pressure_offset) {
  return {wind_row({{.name = "n", .linear = "w_n"}, {.name = "e", .linear = "w_e"}}, largest_wind),
          airspeed_scale_row(ports.airspeed_scale,
                             {{any_driver, "V + s x v"},
                              {"alpha^2", "pressure loss: V + s alpha^2 v", "alpha as read"},
                              {"beta^2", "pressure loss: V + s beta^2 v", "beta as read"}}),
          airspeed_bias_row(ports.airspeed_bias, {{any_driver, "V + s x"}}),
          pressure_offset_row(of_pressure_offset),
          {.port = ports.alpha_offset,
           .sentence = "the angle of attack is off, changing",
           .forms = {{any_driver, "alpha as read + s x"}},
           .curves = {{"beta", "{}^2"}}},
          {.port = ports.beta_offset,
           .sentence = "the angle of sideslip is off, changing",
           .forms = {{any_driver, "beta as read + s x"}}}};
}

EffectRow heading_bias_row() {
  return {
      .entry = CataloguedEffect{"heading_bias", "logged yaw = true yaw + delta", "attitude", "rad"},
      .sentence = "the logged heading is off by a constant",
      .acts_on = ActsOn::world,
      .maker = maker_of(effects::HeadingBias{})};
}

EffectRow lever_arm_row() {
  return {.entry = CataloguedEffect{"lever_arm", "- C_b^n (w x dr) (x, y, z)", "p, q, r", "m"},
          .sentence = "the probe is not where the lever arm says",
          .channels = {"p", "q", "r"},
          .acts_on = ActsOn::world,
          .maker = maker_of(effects::LeverArm{}),
          .plausible = {{"x", near_the_probe}, {"y", near_the_probe}, {"z", near_the_probe}}};
}

EffectRow mounting_error_row() {
  return {.entry = CataloguedEffect{"mounting_error",
                                    "C_b^n R_z(yaw) R_y(pitch): b_alpha, b_beta absorb it",
                                    "attitude", "rad"},
          .sentence = "the probe is mounted at an angle",
          .acts_on = ActsOn::world,
          .maker = maker_of(effects::MountingError{})};
}

EffectRow late_probe_row(const std::vector<std::string>& inputs) {
  return {.entry = CataloguedEffect{"time_offset", "air data late by tau", "none", "s"},
          .sentence = "the sensor's time is late",
          .channels = {"time"},
          .maker = in_time(Delay::Kind::inputs_late, longest_offset, inputs)};
}

EffectRow drifting_probe_row(const std::vector<std::string>& inputs) {
  return {.entry = CataloguedEffect{"clock_drift", "air data late, from 0 at first to tau at last",
                                    "none", "s"},
          .sentence = "the sensor's clock drifts",
          .channels = {"time"},
          .maker = drifting_clock(Delay::Kind::inputs_late, longest_offset, inputs)};
}

EffectRow upwash_row(const FlowPorts& ports, AirspeedColumn airspeed,
                     const std::vector<std::string>& channels) {
  return {.entry = CataloguedEffect{"upwash", "alpha as read + k q / v", "q", "m"},
          .sentence = "the pitch rate turns the flow at the probe",
          .channels = channels,
          .maker = by_rate(ports.alpha_offset, "q", airspeed),
          .plausible = {{"k", near_the_probe}}};
}

EffectRow sidewash_row(const FlowPorts& ports, AirspeedColumn airspeed,
                       const std::vector<std::string>& channels) {
  return {.entry = CataloguedEffect{"sidewash", "beta as read + k p / v", "p", "m"},
          .sentence = "the roll rate turns the flow at the probe",
          .channels = channels,
          .maker = by_rate(ports.beta_offset, "p", airspeed),
          .plausible = {{"k", near_the_probe}}};
}

EffectRow compressibility_row(const FlowPorts& ports, ImpactPressure impact) {
  return {.entry = CataloguedEffect{"compressibility", "V + s (v_c - v), v_c of compressible air",
                                    "ps, density", "1"},
          .sentence = "the air is compressed at this speed",
          .channels = {"ps", "rho"},
          .maker = compressible(ports.airspeed_scale, impact),
          .plausible = {{"s", {0.0, most_compressible}}}};
}

EffectRow angle_loss_row(const FlowPorts& ports, const std::string& equation,
                         double (*lost)(double alpha, double beta)) {
  return {.entry = CataloguedEffect{"angle_loss", equation, "alpha, beta as read", "1"},
          .sentence = "the Pitot hole loses pressure with the flow's angle",
          .channels = {"alpha", "beta"},
          .maker = angle_loss(ports.airspeed_scale, lost),
          .plausible = {{"s", {-most_loss, most_loss}}}};
}

void add_flow_surroundings(EffectTable& table) {
  table.aliases = air_data_aliases("throttle");
  table.channels = air_data_channels();
  table.attitude_errors = {attitude_error("roll"), attitude_error("pitch"), attitude_error("yaw")};
  table.error_budget = {velocity_bound(), gust_bound(), airspeed_bound(), tilt_bound(),
                        heading_bound()};
  table.error_budget[0].outputs = table.error_budget[1].outputs = {"vn", "ve", "vd"};
  table.error_budget[2].port = "airspeed_bias";
}

}  // namespace sepcal::catalogue
