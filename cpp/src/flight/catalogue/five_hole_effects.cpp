// SPDX-License-Identifier: BSD-3-Clause
// The effects on a five-hole probe. x is a driver about its centre, s a coefficient, v the airspeed
// as read and V the corrected one, W the wind, T the temperature.
#include <cmath>
#include <span>
#include <utility>

#include "flight/catalogue/air_data_rows.hpp"
#include "flight/catalogue/effect_makers.hpp"
#include "sepcal/effects/air_data.hpp"
#include "sepcal/run_time_effect.hpp"

namespace sepcal::catalogue {
namespace {

using Setting = EffectSetting;

constexpr double largest_angle = 0.35;           // [rad] of an offset
constexpr double longest_pneumatic_lag = 0.5;    // [s]
constexpr double most_compressible = 3.0;        // of what air is
constexpr double most_loss = 5.0;                // per square of a sine
constexpr Interval near_the_probe{-10.0, 10.0};  // [m] of the probe from where it is said to be

/// Adds a column that an effect derives from others; `value(row)` may be called for every row.
template <class Value>
void derive(Record& record, const std::string& name, const Value& value) {
  if (record.has(name)) return;
  std::vector<double> column(record.length());
  for (std::size_t row = 0; row < column.size(); ++row) column[row] = value(row);
  record.add(name, std::move(column));
}

/// Impact pressure [Pa] of a row.
class Impact {
 public:
  explicit Impact(const Record& record)
      : total_(record.column("pt")), static_(record.column("ps")) {}
  double at(std::size_t row) const { return total_[row] - static_[row]; }

 private:
  std::span<const double> total_;
  std::span<const double> static_;
};

/// The airspeed as read [m/s].
void derive_airspeed(Record& record) {
  const Impact impact(record);
  const auto rho = record.column("rho");
  derive(record, "airspeed as read",
         [&](std::size_t row) { return std::sqrt(2.0 * impact.at(row) / rho[row]); });
}

/// An offset by k times a rate over the airspeed as read [rad/m].
EffectKit::Maker by_rate(Port port, const std::string& rate) {
  port.components.front().name = std::string("k");
  return [=](const BlockModel& model, Setting& setting, Record& record) {
    derive_airspeed(record);
    const auto airspeed = record.column("airspeed as read");
    const auto rates = record.column(rate);
    const std::string name = rate + " / airspeed";
    derive(record, name, [&](std::size_t row) { return rates[row] / airspeed[row]; });
    return make_driven(setting.name, port, power_driver({name, "rad/m"}, 0.0, 1), "m", model,
                       record);
  };
}

/// v by the factor 1 + s / 2T, through the density; its second input is 1 / 2T.
struct TemperatureError {
  static constexpr int corrected = 1;
  static constexpr std::array inputs{Quantity{"rho", "kg/m^3"}, Quantity{"1 / 2T", "1/K"}};
  static constexpr std::array nonlinear{Quantity{"s", "K"}};

  template <class T>
  Vec<T, 1> correct(const Vec<T, 2>& u, const Vec<T, 1>& xi2) const {
    const T factor = 1.0 + xi2[0] * u[1];
    return Vec<T, 1>(u[0] / (factor * factor));
  }
};

/// It acts inside the reading, before lambda_va.
Effect temperature_error(const BlockModel& /*model*/, Setting& setting, Record& record) {
  Effect made{.name = setting.name,
              .port = "reading_scale",
              .driver = derive_half_coldness(record),
              .components = {"s"}};
  made.corrections.push_back(std::make_shared<const StaticCorrection<TemperatureError>>(
      TemperatureError{},
      std::vector<Variable>{{setting.name + ".s", "K", -largest_kelvin, largest_kelvin}}));
  return made;
}

/// The airspeed of compressible air over that of incompressible air, less one: with
/// M^2 = 5 [((pt - ps)/ps + 1)^(2/7) - 1] and the speed of sound sqrt(1.4 ps / rho). In the plain
/// tube the pressures are the noisy measurement itself, which would bias the coefficient.
EffectKit::Maker compressible(const Port& airspeed_scale) {
  return [=](const BlockModel& model, Setting& setting, Record& record) {
    const Impact impact(record);
    const auto ps = record.column("ps");
    const auto rho = record.column("rho");
    derive(record, "compressible share", [&](std::size_t row) {
      const double q = impact.at(row);
      const double mach = std::sqrt(5.0 * (std::pow(q / ps[row] + 1.0, 2.0 / 7.0) - 1.0));
      return std::sqrt(1.4 * ps[row] / rho[row]) * mach / std::sqrt(2.0 * q / rho[row]) - 1.0;
    });
    return make_driven(setting.name, airspeed_scale,
                       power_driver({"compressible share", "1"}, 0.0, 1), "1", model, record);
  };
}

/// By the square of the sine of the flow's whole angle, of the angles as read.
EffectKit::Maker angle_loss(const Port& airspeed_scale) {
  return [=](const BlockModel& model, Setting& setting, Record& record) {
    const auto alpha = record.column("alpha");
    const auto beta = record.column("beta");
    const std::string name = "sin^2 of the flow's angle";
    derive(record, name, [&](std::size_t row) {
      const double along = std::cos(alpha[row]) * std::cos(beta[row]);
      return 1.0 - along * along;
    });
    return make_driven(setting.name, airspeed_scale, power_driver({name, "1"}, 0.0, 1), "1", model,
                       record);
  };
}

}  // namespace

EffectTable five_hole_effects() {
  const Port airspeed_scale{
      "airspeed_scale", "1", {{.name = "s", .linear = "lambda_va"}}, largest_scale};
  const Port airspeed_bias{
      "airspeed_bias", "m/s", {{.name = "s", .linear = "b_va"}}, largest_speed};
  const Port alpha_offset = on_input("alpha_offset", "rad", largest_angle);
  const Port beta_offset = on_input("beta_offset", "rad", largest_angle);
  EffectTable table;
  table.ports = {
      wind_row({{.name = "n", .linear = "w_n"}, {.name = "e", .linear = "w_e"}}, largest_wind),
      airspeed_scale_row(airspeed_scale,
                         {{any_driver, "V + s x v"},
                          {"alpha^2", "pressure loss: V + s alpha^2 v", "alpha as read"},
                          {"beta^2", "pressure loss: V + s beta^2 v", "beta as read"}}),
      airspeed_bias_row(airspeed_bias, {{any_driver, "V + s x"}}),
      pressure_offset_row({{any_driver, "v from (pt - ps) + s x, angles as read"},
                           {"throttle", "propwash: v from (pt - ps) + s T", "throttle"}}),
      {.port = alpha_offset,
       .sentence = "the angle of attack is off, changing",
       .forms = {{any_driver, "alpha as read + s x"}},
       .curves = {{"beta", "{}^2"}}},
      {.port = beta_offset,
       .sentence = "the angle of sideslip is off, changing",
       .forms = {{any_driver, "beta as read + s x"}}}};
  table.effects = {
      {.entry =
           CataloguedEffect{"heading_bias", "logged yaw = true yaw + delta", "attitude", "rad"},
       .sentence = "the logged heading is off by a constant",
       .acts_on = ActsOn::world,
       .maker = maker_of(effects::HeadingBias{})},
      {.entry = CataloguedEffect{"time_offset", "air data late by tau", "none", "s"},
       .sentence = "the sensor's time is late",
       .channels = {"time"},
       .maker =
           in_time(Delay::Kind::inputs_late, longest_offset, {"pt", "ps", "dpa", "dpb", "rho"})},
      {.entry = CataloguedEffect{"clock_drift", "air data late, from 0 at first to tau at last",
                                 "none", "s"},
       .sentence = "the sensor's clock drifts",
       .channels = {"time"},
       .maker = drifting_clock(Delay::Kind::inputs_late, longest_offset,
                               {"pt", "ps", "dpa", "dpb", "rho"})},
      {.entry =
           CataloguedEffect{"pneumatic_lag", "tau dp/dt + p = p0 on every pressure", "none", "s"},
       .sentence = "the pressures lag in their tubes",
       .channels = {"time"},
       .maker =
           in_time(Delay::Kind::inputs_lagging, longest_pneumatic_lag, {"pt", "ps", "dpa", "dpb"}),
       .plausible = {{"tau", {0.0, longest_pneumatic_lag}}}},
      {.entry = CataloguedEffect{"lever_arm", "- C_b^n (w x dr) (x, y, z)", "p, q, r", "m"},
       .sentence = "the probe is not where the lever arm says",
       .channels = {"p", "q", "r"},
       .acts_on = ActsOn::world,
       .maker = maker_of(effects::LeverArm{}),
       .plausible = {{"x", near_the_probe}, {"y", near_the_probe}, {"z", near_the_probe}}},
      {.entry = CataloguedEffect{"density_error", "v (1 + s / 2T): the temperature is off by s",
                                 "temp_k", "K"},
       .sentence = "the temperature behind the density is off",
       .channels = {"temperature"},
       .maker = temperature_error},
      {.entry = CataloguedEffect{"compressibility", "V + s (v_c - v), v_c of compressible air",
                                 "ps, density", "1"},
       .sentence = "the air is compressed at this speed",
       .channels = {"ps", "rho"},
       .maker = compressible(airspeed_scale),
       .plausible = {{"s", {0.0, most_compressible}}}},
      {.entry =
           CataloguedEffect{"angle_loss", "pressure loss: V + s (1 - cos^2 alpha cos^2 beta) v",
                            "alpha, beta as read", "1"},
       .sentence = "the centre hole loses pressure with the flow's angle",
       .channels = {"alpha", "beta"},
       .maker = angle_loss(airspeed_scale),
       .plausible = {{"s", {-most_loss, most_loss}}}},
      {.entry = CataloguedEffect{"upwash", "alpha as read + k q / v", "q", "m"},
       .sentence = "the pitch rate turns the flow at the probe",
       .channels = {"q", "rho"},
       .maker = by_rate(alpha_offset, "q"),
       .plausible = {{"k", near_the_probe}}},
      {.entry = CataloguedEffect{"sidewash", "beta as read + k p / v", "p", "m"},
       .sentence = "the roll rate turns the flow at the probe",
       .channels = {"p", "rho"},
       .maker = by_rate(beta_offset, "p"),
       .plausible = {{"k", near_the_probe}}},
      pressure_zero_row("v from (pt - ps) + s, angles as read"),
      icing_ramp_row("V + s (t - t0)+ v, t0 fitted", airspeed_scale),
      water_blockage_row("V + s v from t0 on, t0 by a scan", airspeed_scale),
      {.entry = CataloguedEffect{"mounting_error",
                                 "C_b^n R_z(yaw) R_y(pitch): b_alpha, b_beta absorb it", "attitude",
                                 "rad"},
       .sentence = "the probe is mounted at an angle",
       .acts_on = ActsOn::world,
       .maker = maker_of(effects::MountingError{})}};
  table.aliases = air_data_aliases("throttle");
  table.channels = air_data_channels();
  table.wandering = {wandering_angle("roll"), wandering_angle("pitch"), wandering_angle("yaw")};
  table.wanders = {velocity_bound(), gust_bound(), airspeed_bound(), tilt_bound(), heading_bound()};
  table.wanders[0].outputs = table.wanders[1].outputs = {"vn", "ve", "vd"};
  table.wanders[2].port = "airspeed_bias";
  table.disturbed = {"pt", "dpa", "dpb"};
  return table;
}

}  // namespace sepcal::catalogue
