// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/air_data_rows.hpp"

#include "flight/catalogue/effect_makers.hpp"

namespace sepcal::catalogue {

Port on_input(const std::string& name, const std::string& unit, double plausible) {
  return {name, unit, {{.name = "s", .input = name}}, plausible};
}

PortRow wind_row(const std::vector<Port::Component>& components, double plausible) {
  return {.port = Port{.name = "wind",
                       .unit = "m/s",
                       .components = components,
                       .plausible = plausible,
                       .causes = time_and_place()},
          .sentence = "the wind changes",
          .acts_on = ActsOn::world,
          .forms = {{any_driver, "W + s x (n, e)"},
                    {"altitude_m", "shear: W + s (h - h0) (n, e)", "altitude_m"},
                    {"time", "drift: W + s (t - t0) (n, e)", "time"},
                    {"spline(time,6)", "W + a smooth of time, 6 knots (n, e)", "time"},
                    {"maneuver", "a wind for every label but the first (n, e)", "maneuver"}},
          .curves = {{"time", "spline({},6)"},
                     {"time", "spline({},12)"},
                     {"altitude", "spline({},6)"},
                     {"altitude", "{}^2"}},
          .by_maneuver = "the wind is another one in every maneuver"};
}

PortRow airspeed_scale_row(const Port& port, const std::vector<Form>& forms) {
  return {.port = port,
          .sentence = "the airspeed's scale changes",
          .forms = forms,
          .curves = {{"alpha", "{}^2"}, {"beta", "{}^2"}}};
}

PortRow airspeed_bias_row(const Port& port, const std::vector<Form>& forms) {
  return {.port = port, .sentence = "the airspeed's bias changes", .forms = forms};
}

namespace {

Port pressure_offset() {
  Port port = on_input("pressure_offset", "Pa", 1000.0);
  port.constant_is_own = false;  // the models have a constant error of airspeed, not of pressure
  return port;
}

}  // namespace

PortRow pressure_offset_row(const std::vector<Form>& forms) {
  return {.port = pressure_offset(),
          .sentence = "the pressure difference is off, changing",
          .forms = forms,
          .channels = {"rho"}};
}

EffectRow pressure_zero_row(const std::string& equation) {
  const Port port = pressure_offset();
  return {.entry = CataloguedEffect{port.name, equation, "density", port.unit},
          .sentence = "the zero of the pressure difference is off",
          .maker = lacking_constant_on(port),
          .better_with = {"rho"}};
}

EffectRow density_error_row(const std::string& equation, const Port& airspeed_scale) {
  return {.entry = CataloguedEffect{"density_error", equation, "temp_k", "K"},
          .sentence = "the temperature behind the density is off",
          .channels = {"temperature"},
          .maker =
              [=](const BlockModel& model, EffectSetting& setting, Record& record) {
                return make_driven(setting.name, airspeed_scale, derive_half_coldness(record), "K",
                                   model, record);
              },
          .plausible = {{"s", {-largest_kelvin, largest_kelvin}}}};
}

EffectRow icing_ramp_row(const std::string& equation, const Port& airspeed_scale) {
  return {.entry = CataloguedEffect{"icing_ramp", equation, "time", "1 per s"},
          .sentence = "the airspeed's scale drifts steadily from some time on",
          .channels = {"time"},
          .maker = renamed("airspeed_scale[ramp(time)]", airspeed_scale)};
}

EffectRow water_blockage_row(const std::string& equation, const Port& airspeed_scale) {
  return {.entry = CataloguedEffect{"water_blockage", equation, "time", "1"},
          .sentence = "the airspeed's scale changes at one time",
          .channels = {"time"},
          .maker = renamed("airspeed_scale[step(time)]", airspeed_scale)};
}

std::vector<AliasRow> air_data_aliases(const std::string& drivers_of_propwash) {
  return {{"wind_shear", "wind[altitude_*]", "altitude_*", "m/s per m"},
          {"wind_drift", "wind[time]", "time", "m/s per s"},
          {"propwash", "pressure_offset[throttle]", drivers_of_propwash, "Pa"}};
}

std::vector<Channel> air_data_channels() {
  return {{"altitude", "altitude_m"}, {"throttle", "throttle"}, {"temp", "temp_degc"},
          {"flap", "flap"},           {"p_", "p_radps"},        {"q_", "q_radps"},
          {"r_", "r_radps"}};
}

ErrorBound velocity_bound() { return {.name = "velocity", .unit = "m/s", .size = 0.15}; }

ErrorBound gust_bound() { return {.name = "gusts", .unit = "m/s", .size = 0.35, .time_s = 15.0}; }

ErrorBound airspeed_bound() { return {.name = "airspeed", .unit = "m/s", .size = 0.2}; }

DriverPointer derive_half_coldness(Record& record) {
  const std::string name = "1 / 2T";
  if (!record.has(name)) {
    std::vector<double> half_coldness;
    for (const double kelvin : record.column("temperature")) half_coldness.push_back(0.5 / kelvin);
    record.add(name, std::move(half_coldness));
  }
  return power_driver({name, "1/K"}, 0.0, 1);
}

}  // namespace sepcal::catalogue
