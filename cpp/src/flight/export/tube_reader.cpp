// SPDX-License-Identifier: BSD-3-Clause
// A device id of PX4 says in its third byte what kind of device it is (drv_sensor.h). ArduPilot's
// ARSPD_TYPE 6 is an SDP3x.
#include "flight/export/tube_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "flight/export/parameters.hpp"
#include "flight/files/headers.hpp"
#include "sepcal/error.hpp"

namespace sepcal::exporting {
namespace {

constexpr AirspeedSensor membrane = AirspeedSensor::membrane;
constexpr AirspeedSensor sdp3x = AirspeedSensor::sdp3x;
constexpr std::array px4_defaults{0.0, 0.2, 1.5};
constexpr double ardupilot_sdp3x = 6.0;

struct Device {
  std::uint32_t kind;
  PressureSensor sensor;
};
constexpr std::array px4_devices{
    Device{0x15, {"simulated", membrane}}, Device{0x46, {"ETS3", membrane}},
    Device{0x47, {"MS4515", membrane}},    Device{0x48, {"MS4525DO", membrane}},
    Device{0x49, {"MS5525DSO", membrane}}, Device{0x4A, {"SDP31", sdp3x}},
    Device{0x4B, {"SDP32", sdp3x}},        Device{0x4C, {"SDP33", sdp3x}},
    Device{0x83, {"on CAN", membrane}},    Device{0xE4, {"ASP5033", membrane}},
    Device{0xE6, {"AUAV", membrane}}};

std::uint32_t kind_of(std::uint32_t device_id) { return (device_id >> 16) & 0xFF; }

/// A parameter of the vehicle that the log has a column of, one value throughout.
std::optional<double> constant_column(const Flight& flight, std::string_view header) {
  const Flight::Column* const column = flight.find(header);
  if (column == nullptr || column->values.empty()) return std::nullopt;
  const double first = column->values.front();
  if (std::ranges::any_of(column->values, [&](double value) { return value != first; })) {
    throw Error(fmt::format("{}: {} changes within the flight; take a part in which it does not",
                            flight.name(), header));
  }
  return first;
}

/// How PX4 finds out: the driver's kind of device.
class SensorOfFlight {
 public:
  SensorOfFlight(const Flight& flight, const ExportOptions& options)
      : flight_(flight), options_(options) {}

  AirspeedSensor find(std::vector<std::string>& notes) const {
    if (options_.airspeed_sensor) return *options_.airspeed_sensor;
    const bool px4 = options_.target == ExportTarget::px4;
    if (options_.device_id) return by_device(*options_.device_id, notes);
    if (const auto logged = constant_column(flight_, px4 ? "air_device_id" : "arspd_type")) {
      if (px4) return by_device(static_cast<std::uint32_t>(*logged), notes);
      notes.push_back(fmt::format("the sensor is by the log's ARSPD_TYPE, {:.0f}", *logged));
      return *logged == ardupilot_sdp3x ? sdp3x : membrane;
    }
    say_unknown("the sensor is not known", notes);
    return membrane;
  }

 private:
  AirspeedSensor by_device(std::uint32_t id, std::vector<std::string>& notes) const {
    if (const auto sensor = px4_pressure_sensor(id)) {
      notes.push_back(fmt::format("the sensor's device id, {}, says {}", id, sensor->name));
      return sensor->kind;
    }
    say_unknown(fmt::format("the sensor's device id, {}, says a kind, {:#x}, that is not known", id,
                            kind_of(id)),
                notes);
    return membrane;
  }

  void say_unknown(const std::string& what, std::vector<std::string>& notes) const {
    const bool px4 = options_.target == ExportTarget::px4;
    notes.push_back(fmt::format(
        "{}, and its pressure is taken as it is: with an SDP31, 32 or 33 {} adds what the flow "
        "through it loses, and {}; then give the airspeed sensor sdp3x{}",
        what, px4 ? "PX4" : "ArduPilot",
        px4 ? "this scale is too large by a quarter to a half" : "this ratio is 1 to 5 % off",
        px4 ? ", or the sensor's device id" : ""));
  }

  const Flight& flight_;
  const ExportOptions& options_;
};

std::array<double, 3> logged_cal_air(const Flight& flight) {
  constexpr std::array headers{"cal_air_cmodel", "cal_air_tubelen_m", "cal_air_tubed_mm"};
  std::array<double, 3> values = px4_defaults;
  for (std::size_t i = 0; i < headers.size(); ++i) {
    if (const auto logged = constant_column(flight, headers[i])) values[i] = *logged;
  }
  return values;
}

AirspeedReader px4_reader(const Flight& flight, const ExportOptions& options,
                          std::vector<std::string>& notes) {
  const std::array<double, 3> values = options.cal_air ? *options.cal_air : logged_cal_air(flight);
  notes.push_back(fmt::format(
      "the scale holds beside a CAL_AIR_CMODEL of {:g}, a CAL_AIR_TUBELEN of {:g} m and a "
      "CAL_AIR_TUBED_MM of {:g}, which are not in the file",
      values[0], values[1], values[2]));
  return AirspeedReader::px4(values);
}

}  // namespace

ChosenTubeReader choose_tube_reader(const Flight& flight, const ExportOptions& options) {
  const bool px4 = options.target == ExportTarget::px4;
  ChosenTubeReader chosen;
  TubeReader& reader = chosen.reader;
  reader.logged = options.logged_airspeed;
  reader.has_airspeed =
      files::find_quantity(flight, "airspeed", files::UnitKind::speed).has_value();
  const auto idle = [&](const char* option, const char* of) {
    throw OptionError({Option{option}, std::string(" is of ") + of + "; leave it out"});
  };
  const bool flows = SensorOfFlight(flight, options).find(chosen.notes) == sdp3x;
  if (options.cal_air && !(px4 && flows)) idle("cal_air", "PX4 with an SDP3x");
  if (!reader.has_airspeed) {
    const char* const logged = "a logged airspeed, and what was read is dp_pa";
    if (options.in_use) idle("in_use", logged);
    if (reader.logged == LoggedAirspeed::equivalent) idle("logged_airspeed", logged);
  }
  if (flows) {
    reader.sensor = px4 ? px4_reader(flight, options, chosen.notes) : AirspeedReader::ardupilot();
  }
  reader.has_offset = px4 || !flows;
  if (options.in_use) {
    reader.in_use = px4 ? *options.in_use : std::sqrt(*options.in_use / plain_ratio_of(flows));
  }
  return chosen;
}

}  // namespace sepcal::exporting

namespace sepcal {

std::optional<PressureSensor> px4_pressure_sensor(std::uint32_t device_id) {
  using namespace exporting;
  const auto* const found = std::ranges::find(px4_devices, kind_of(device_id), &Device::kind);
  return found == px4_devices.end() ? std::nullopt : std::optional(found->sensor);
}

double sdp3x_pressure(double handed_on, double ratio, double static_pressure, double temperature) {
  if (!(handed_on > 0.0) || !(ratio > 0.0)) return handed_on;
  const exporting::Air air{.pressure = static_pressure, .temperature = temperature};
  const double factor = std::sqrt(ratio / exporting::plain_ratio_of(true));
  return exporting::AirspeedReader::ardupilot().pressure_behind(std::sqrt(ratio * handed_on),
                                                                factor, air);
}

}  // namespace sepcal
