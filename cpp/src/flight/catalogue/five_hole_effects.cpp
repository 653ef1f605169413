// SPDX-License-Identifier: BSD-3-Clause
// The effects on a five-hole probe. x is a driver about its centre, s a coefficient, v the airspeed
// as read and V the corrected one, W the wind, T the temperature.
#include <cmath>
#include <memory>

#include "flight/catalogue/effect_makers.hpp"
#include "flight/catalogue/flow_angle_rows.hpp"
#include "sepcal/detail/run_time_effect.hpp"

namespace sepcal::catalogue {
namespace {

using Setting = EffectSetting;

std::function<double(std::size_t)> impact_in_the_holes(const Record& record) {
  return [total = record.column("pt"), fixed = record.column("ps")](std::size_t row) {
    return total[row] - fixed[row];
  };
}

std::string_view airspeed_in_the_holes(Record& record) {
  const auto impact = impact_in_the_holes(record);
  const auto rho = record.column("rho");
  derive(record, "airspeed as read",
         [&](std::size_t row) { return std::sqrt(2.0 * impact(row) / rho[row]); });
  return "airspeed as read";
}

double lost_at_the_centre(double alpha, double beta) {
  const double along = std::cos(alpha) * std::cos(beta);
  return 1.0 - along * along;
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

}  // namespace

EffectTable five_hole_effects() {
  const FlowPorts ports = flow_ports();
  const std::vector<std::string> readings{"pt", "ps", "dpa", "dpb", "rho"};
  EffectTable table;
  table.ports =
      flow_port_rows(ports, {{any_driver, "v from (pt - ps) + s x, angles as read"},
                             {"throttle", "propwash: v from (pt - ps) + s T", "throttle"}});
  table.effects = {
      heading_bias_row(),
      late_probe_row(readings),
      drifting_probe_row(readings),
      {.entry =
           CataloguedEffect{"pneumatic_lag", "tau dp/dt + p = p0 on every pressure", "none", "s"},
       .sentence = "the pressures lag in their tubes",
       .channels = {"time"},
       .maker = in_time(Delay::Kind::inputs_lagging, longest_probe_lag, {"pt", "ps", "dpa", "dpb"}),
       .plausible = {{"tau", {0.0, longest_probe_lag}}}},
      lever_arm_row(),
      {.entry = CataloguedEffect{"density_error", "v (1 + s / 2T): the temperature is off by s",
                                 "temp_k", "K"},
       .sentence = "the temperature behind the density is off",
       .channels = {"temperature"},
       .maker = temperature_error},
      compressibility_row(ports, impact_in_the_holes),
      angle_loss_row(ports, "pressure loss: V + s (1 - cos^2 alpha cos^2 beta) v",
                     lost_at_the_centre),
      upwash_row(ports, airspeed_in_the_holes, {"q", "rho"}),
      sidewash_row(ports, airspeed_in_the_holes, {"p", "rho"}),
      pressure_zero_row("v from (pt - ps) + s, angles as read"),
      icing_ramp_row("V + s (t - t0)+ v, t0 fitted", ports.airspeed_scale),
      water_blockage_row("V + s v from t0 on, t0 by a scan", ports.airspeed_scale),
      mounting_error_row()};
  add_flow_surroundings(table);
  table.disturbed = {"pt", "dpa", "dpb"};
  return table;
}

}  // namespace sepcal::catalogue
