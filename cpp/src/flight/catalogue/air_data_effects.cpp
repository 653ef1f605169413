// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/air_data_effects.hpp"

#include <cmath>
#include <span>
#include <utility>

#include "flight/catalogue/effect_makers.hpp"
#include "sepcal/effects/air_data.hpp"
#include "sepcal/static_effect.hpp"

namespace sepcal::catalogue {
namespace {

using Component = Port::Component;
using Setting = EffectSetting;

constexpr double largest_angle = 0.35;       // [rad] of an offset or a bias
constexpr double largest_wind = 200.0;       // [m/s]
constexpr double largest_scale = 0.5;        // [1]
constexpr double largest_pressure = 1000.0;  // [Pa]
constexpr double largest_speed = 50.0;       // [m/s] of a bias
constexpr double longest_offset = 0.5;       // [s]
constexpr double longest_lag = 0.5;          // [s]

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

/// A rate over the airspeed as read [rad/m].
DriverPointer rate_over_airspeed(Record& record, const std::string& rate) {
  derive_airspeed(record);
  const auto airspeed = record.column("airspeed as read");
  const auto rates = record.column(rate);
  const std::string name = rate + " / airspeed";
  derive(record, name, [&](std::size_t row) { return rates[row] / airspeed[row]; });
  return power_driver({name, "rad/m"}, 0.0, 1);
}

/// 1 / 2T [1/K] of the logged temperature.
DriverPointer derive_half_coldness(Record& record) {
  need_columns("density_error", record, {"temperature"});
  const auto temperature = record.column("temperature");
  derive(record, "1 / 2T", [&](std::size_t row) { return 0.5 / temperature[row]; });
  return power_driver({"1 / 2T", "1/K"}, 0.0, 1);
}

/// An error of the temperature by s [K] changes the airspeed as read by s v / 2T: in the five-hole
/// probe inside the reading, before lambda_va.
Effect density_error(const BlockModel& /*model*/, Setting& /*setting*/, Record& record) {
  const DriverPointer driver = derive_half_coldness(record);
  Effect made = effect("density_error", effects::DensityError{});
  made.port = "reading_scale";
  made.driver = driver;
  made.components = {"s"};
  return made;
}

/// The same in the plain tube, whose own scale comes after the effects.
EffectKit::Maker density_error_at_the_tube(const Port& port) {
  return [port](const BlockModel& model, Setting& /*setting*/, Record& record) {
    return make_driven("density_error", port, derive_half_coldness(record), "K", model, record);
  };
}

/// The airspeed of compressible air over that of incompressible air, less one: with
/// M^2 = 5 [((pt - ps)/ps + 1)^(2/7) - 1] and the speed of sound sqrt(1.4 ps / rho). In the plain
/// tube the pressures are the noisy measurement itself, which would bias the coefficient.
EffectKit::Maker compressibility(const Port& port) {
  return [port](const BlockModel& model, Setting& /*setting*/, Record& record) {
    need_columns("compressibility", record, {"ps", "rho"});
    const Impact impact(record);
    const auto ps = record.column("ps");
    const auto rho = record.column("rho");
    derive(record, "compressible share", [&](std::size_t row) {
      const double q = impact.at(row);
      const double mach = std::sqrt(5.0 * (std::pow(q / ps[row] + 1.0, 2.0 / 7.0) - 1.0));
      return std::sqrt(1.4 * ps[row] / rho[row]) * mach / std::sqrt(2.0 * q / rho[row]) - 1.0;
    });
    return make_driven("compressibility", port, power_driver({"compressible share", "1"}, 0.0, 1),
                       "1", model, record);
  };
}

EffectKit::Maker by_rate(const std::string& name, Port port, const std::string& rate) {
  port.components.front().name = std::string("k");
  port.plausible = largest_angle;
  return [=](const BlockModel& model, Setting& /*setting*/, Record& record) {
    need_columns(name, record, {rate.c_str(), "rho"});
    return make_driven(name, port, rate_over_airspeed(record, rate), "m", model, record);
  };
}

EffectKit::Maker lever_arm() {
  return [](const BlockModel& /*model*/, Setting& /*setting*/, Record& record) {
    need_columns("lever_arm", record, {"p", "q", "r"});
    return effect("lever_arm", effects::LeverArm{});
  };
}

void add_shared(EffectKit& kit, const Port& airspeed_scale) {
  kit.own["icing_ramp"] = renamed("icing_ramp", "airspeed_scale[ramp(time)]", airspeed_scale);
  kit.own["water_blockage"] =
      renamed("water_blockage", "airspeed_scale[step(time)]", airspeed_scale);
  kit.aliases["wind_shear"] = by_column("wind_shear", "wind", "altitude");
  kit.aliases["wind_drift"] = [](const Record&) { return "wind[time]"; };
  kit.aliases["propwash"] = [](const Record&) { return "pressure_offset[throttle]"; };
}

Port on_input(const std::string& name, const std::string& unit, double plausible) {
  return {name, unit, {Component{.name = "s", .input = name}}, plausible};
}

}  // namespace

EffectKit five_hole_effects() {
  const Port airspeed_scale{"airspeed_scale", "1", {Component{.name = "s", .linear = "lambda_va"}}};
  const Port alpha_offset = on_input("alpha_offset", "rad", largest_angle);
  const Port beta_offset = on_input("beta_offset", "rad", largest_angle);
  EffectKit kit;
  kit.ports = {{"wind",
                "m/s",
                {Component{.name = "n", .linear = "w_n"}, Component{.name = "e", .linear = "w_e"}}},
               airspeed_scale,
               {"airspeed_bias", "m/s", {Component{.name = "s", .linear = "b_va"}}},
               on_input("pressure_offset", "Pa", largest_pressure),
               alpha_offset,
               beta_offset};
  add_shared(kit, airspeed_scale);
  kit.own["density_error"] = density_error;
  kit.own["compressibility"] = compressibility(airspeed_scale);
  kit.own.insert(own_effect("heading_bias", effects::HeadingBias{}));
  kit.own["lever_arm"] = lever_arm();
  kit.own.insert(own_effect("mounting_error", effects::MountingError{}));
  kit.own["upwash"] = by_rate("upwash", alpha_offset, "q");
  kit.own["sidewash"] = by_rate("sidewash", beta_offset, "p");
  kit.own["time_offset"] = in_time("time_offset", Delay::Kind::inputs_late, longest_offset,
                                   {"pt", "ps", "dpa", "dpb", "rho"});
  kit.own["pneumatic_lag"] = in_time("pneumatic_lag", Delay::Kind::inputs_lagging, longest_lag,
                                     {"pt", "ps", "dpa", "dpb"});
  return kit;
}

EffectKit pitot_static_effects() {
  const Port airspeed_scale = on_input("airspeed_scale", "1", largest_scale);
  EffectKit kit;
  kit.ports = {{"wind",
                "m/s",
                {Component{.name = "n", .input = "vn", .sign = -1.0},
                 Component{.name = "e", .input = "ve", .sign = -1.0}},
                largest_wind},
               airspeed_scale,
               on_input("airspeed_bias", "m/s", largest_speed),
               on_input("pressure_offset", "Pa", largest_pressure)};
  add_shared(kit, airspeed_scale);
  kit.own["density_error"] = density_error_at_the_tube(airspeed_scale);
  kit.own["time_offset"] = in_time("time_offset", Delay::Kind::outputs_late, longest_offset);
  kit.own["pneumatic_lag"] = in_time("pneumatic_lag", Delay::Kind::outputs_lagging, 0.2);
  return kit;
}

}  // namespace sepcal::catalogue
