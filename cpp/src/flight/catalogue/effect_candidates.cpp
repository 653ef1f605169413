// SPDX-License-Identifier: BSD-3-Clause
#include "flight/catalogue/effect_candidates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "sepcal/effect_name.hpp"

namespace sepcal::catalogue {
namespace {

constexpr std::array states{"time", "alpha", "beta", "q", "r"};

/// Channels under their own header; what is measured can't drive an effect.
std::vector<std::string> list_drivers(const Record& record, const Flight& flight) {
  std::vector<std::string> drivers(states.begin(), states.end());
  std::erase_if(drivers, [&](const std::string& state) { return !record.has(state); });
  for (const std::string& name : record.names()) {
    if (flight.find(name) != nullptr) drivers.push_back(name);
  }
  return drivers;
}

/// Curved and smooth forms, by port and by how the channel's name begins.
struct Curved {
  std::string_view port;
  std::string_view channel;
  std::string_view form;
};
constexpr std::array curved_forms{
    Curved{"wind", "time", "spline({},6)"},
    Curved{"wind", "time", "spline({},12)"},
    Curved{"wind", "altitude", "spline({},6)"},
    Curved{"wind", "altitude", "{}^2"},
    Curved{"airspeed_scale", "alpha", "{}^2"},
    Curved{"airspeed_scale", "beta", "{}^2"},
    Curved{"alpha_offset", "beta", "{}^2"},
    Curved{"bias", "time", "spline({},6)"},
    Curved{"bias", "temp", "{}^2"},
    Curved{"bias", "throttle", "{}^n"},
    Curved{"bias", "current", "delay({})"},
};

struct Channel {
  std::string_view beginning;  // of the header
  std::string_view name;       // that a log would give it
};
constexpr std::array air_channels{
    Channel{"altitude", "altitude_m"}, Channel{"throttle", "throttle"},
    Channel{"temp", "temp_degc"},      Channel{"flap", "flap"},
    Channel{"p_", "p_radps"},          Channel{"q_", "q_radps"},
    Channel{"r_", "r_radps"}};
constexpr std::array magnetic_channels{
    Channel{"current", "current_a"}, Channel{"throttle", "throttle"},
    Channel{"voltage", "voltage_v"}, Channel{"temp", "temp_degc"}};

template <class Channels>
std::vector<std::string> not_logged(const Channels& channels, const Flight& flight) {
  std::vector<std::string> missing;
  for (const Channel& channel : channels) {
    const bool logged = std::ranges::any_of(flight.columns(), [&](const Flight::Column& column) {
      return column.header.starts_with(channel.beginning);
    });
    if (!logged) missing.emplace_back(channel.name);
  }
  return missing;
}

std::string describe_driver(const EffectName& name) {
  switch (name.shape) {
    case EffectName::Shape::spline:
      return fmt::format("smoothly with {}", name.base);
    case EffectName::Shape::power:
      return name.number > 1 ? fmt::format("with {}^{}", name.base, name.number)
                             : fmt::format("with {}", name.base);
    case EffectName::Shape::exponent:
      return fmt::format("with a power of {}", name.base);
    case EffectName::Shape::step:
      return "at one time";
    case EffectName::Shape::ramp:
      return "steadily from some time on";
    case EffectName::Shape::decay:
      return "and settles";
    default:
      return fmt::format("with {}, delayed", name.base);
  }
}

}  // namespace

std::vector<std::string> list_candidates(const EffectKit& kit, const Record& record,
                                         const Flight& flight) {
  std::vector<std::string> names;
  for (const auto& [name, maker] : kit.own) names.push_back(name);
  const std::vector<std::string> drivers = list_drivers(record, flight);
  for (const Port& port : kit.ports) {
    for (const std::string& driver : drivers) {
      names.push_back(fmt::format("{}[{}]", port.name, driver));
      for (const Curved& curved : curved_forms) {
        if (curved.port != port.name || !driver.starts_with(curved.channel)) continue;
        names.push_back(
            fmt::format("{}[{}]", port.name, fmt::format(fmt::runtime(curved.form), driver)));
      }
    }
  }
  if (!flight.maneuvers().empty()) {
    for (const Port& port : kit.ports) {
      if (port.name == "wind") names.emplace_back("wind[maneuver]");
    }
  }
  return names;
}

std::vector<std::string> list_missing_channels(std::string_view probe, const Flight& flight) {
  return probe.starts_with("magnetometer") ? not_logged(magnetic_channels, flight)
                                           : not_logged(air_channels, flight);
}

std::string describe_effect(const std::string& name) {
  static const std::map<std::string, std::string> own{
      {"heading_bias", "the logged heading is off by a constant"},
      {"time_offset", "the sensor's time is late"},
      {"pneumatic_lag", "the pressures lag in their tubes"},
      {"lever_arm", "the probe is not where the lever arm says"},
      {"density_error", "the temperature behind the density is off"},
      {"compressibility", "the air is compressed at this speed"},
      {"upwash", "the pitch rate turns the flow at the probe"},
      {"sidewash", "the roll rate turns the flow at the probe"},
      {"icing_ramp", "the airspeed's scale drifts steadily from some time on"},
      {"water_blockage", "the airspeed's scale changes at one time"},
      {"mounting_error", "the probe is mounted at an angle"},
      {"bias_step", "something was switched on that bends the field"},
      {"warm_up", "the sensor's bias settles after it is switched on"},
      {"cubic_nonlinearity", "the sensor's response is curved"},
      {"eddy_currents", "eddy currents follow the turning field"},
      {"sensor_lag", "the sensor lags"},
      {"field_declination", "the field's declination is off"},
      {"attitude_bias", "the logged roll or pitch is off by a constant"}};
  static const std::map<std::string, std::string> ports{
      {"wind", "the wind changes"},
      {"airspeed_scale", "the airspeed's scale changes"},
      {"airspeed_bias", "the airspeed's bias changes"},
      {"pressure_offset", "the pressure difference is off, changing"},
      {"alpha_offset", "the angle of attack is off, changing"},
      {"beta_offset", "the angle of sideslip is off, changing"},
      {"bias", "the field at the sensor changes"},
      {"scale", "the sensor's scale changes"},
      {"axis_scale", "the scales of the sensor's axes change"}};
  std::string sentence;
  for (const std::string& part : split_effects(name)) {
    if (!sentence.empty()) sentence += ", and ";
    const auto known = own.find(part);
    if (known != own.end()) {
      sentence += known->second;
      continue;
    }
    const EffectName parsed = parse_effect_name(part);
    const auto port = ports.find(parsed.port);
    if (parsed.shape == EffectName::Shape::none) {
      sentence += "your own effect " + part;
    } else if (parsed.base == "maneuver") {
      sentence += "the wind is another one in every maneuver";
    } else {
      sentence += fmt::format(
          "{} {}", port == ports.end() ? fmt::format("{} changes", parsed.port) : port->second,
          describe_driver(parsed));
    }
  }
  return sentence;
}

}  // namespace sepcal::catalogue
