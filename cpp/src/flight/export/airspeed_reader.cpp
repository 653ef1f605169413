// SPDX-License-Identifier: BSD-3-Clause
// PX4: lib/airspeed, calc_IAS_corrected(). ArduPilot: AP_Airspeed_SDP3X, _correct_pressure(), whose
// correction of the pressure is such that sqrt(ratio * pressure) is what stands here.
#include "flight/export/airspeed_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "flight/export/parameters.hpp"
#include "sepcal/error.hpp"

namespace sepcal::exporting {
namespace {

constexpr double gas_constant = 287.1;       // [J/(kg K)], as both autopilots have it
constexpr double sensor_density = 1.29;      // [kg/m^3], at which the flow was measured
constexpr double sensor_pressure = 96600.0;  // [Pa], likewise

double density_of(const Air& air) { return air.pressure / (gas_constant * air.temperature); }

/// Through the sensor [ml/s at the density it was measured at], by the pressure across it [Pa].
double flow_through(double dp, double density) {
  const double flow = 300.805 - 300.878 / (0.00344205 * std::pow(dp, 0.68698) + 1.0);
  return std::max(0.0, flow * sensor_density / density);
}

double speed_of(double dp) { return std::sqrt(2.0 * dp / sea_level_density); }

IndicatedAirspeed indicate_ardupilot(double dp, double density) {
  const double flow = flow_through(dp, density);
  const double tip = 28557670.0 * (1.0 - 1.0 / (1.0 + std::pow(flow / 5027611.0, 1.227924)));
  return {.scaled = speed_of(dp + tip), .added = 0.0331582 * flow};
}

}  // namespace

AirspeedReader AirspeedReader::px4(const std::array<double, 3>& cal_air) {
  const auto [model, length, diameter_mm] = cal_air;
  const auto refuse = [](const std::string& why) { throw OptionError({Option{"cal_air"}, why}); };
  if (model != std::round(model) || model < 0 || model > 3) {
    refuse(fmt::format(": CAL_AIR_CMODEL {:g} is none that sepcal knows; it knows 0 to 3", model));
  }
  if (!(length >= 0 && length <= 10)) {
    refuse(fmt::format(": CAL_AIR_TUBELEN {:g} m is no tube's length; give 0 to 10", length));
  }
  if (!(diameter_mm > 0 && diameter_mm <= 100)) {
    refuse(
        fmt::format(": CAL_AIR_TUBED_MM {:g} is no tube's diameter; give more than 0, at most "
                    "100",
                    diameter_mm));
  }
  AirspeedReader reader;
  reader.model_ = static_cast<FlowModel>(static_cast<int>(model));
  reader.length_ = length;
  reader.diameter_ = 1e-3 * diameter_mm;
  return reader;
}

AirspeedReader AirspeedReader::ardupilot() {
  AirspeedReader reader;
  reader.model_ = FlowModel::ardupilot;
  return reader;
}

IndicatedAirspeed AirspeedReader::indicate(double dp, const Air& air) const {
  if (!(dp > 0.0)) return {};
  if (!flows()) return {.scaled = speed_of(dp)};
  if (model_ == FlowModel::ardupilot) return indicate_ardupilot(dp, density_of(air));
  return indicate_px4(dp, air);
}

IndicatedAirspeed AirspeedReader::indicate_px4(double dp, const Air& air) const {
  if (model_ == FlowModel::tube_loss) return {.scaled = speed_of(less_along_tube(dp, air))};
  const double density = density_of(air);
  const double ratio = sensor_density / density;
  const double across = dp * sensor_pressure / air.pressure;
  const double flow = flow_through(across, density);
  const double tip = (0.0032 * flow * flow + 0.0123 * flow + 1.0) * ratio;
  const double tube = flow * 0.674 / 450.0 * length_ / ratio;
  const double lost = tube + (model_ == FlowModel::no_pitot ? 0.0 : tip);
  return {.scaled = speed_of(across + lost) + 0.125 * flow};
}

/// The pressure before a laminar flow's loss along the tubes.
double AirspeedReader::less_along_tube(double dp, const Air& air) const {
  constexpr double mass_flow = 4.79e-7;  // through the sensor [kg/s]
  constexpr double turning = 59.3319;    // [Pa], where a linear and a square part are equal
  const double viscosity = (18.205 + 0.0484 * (air.temperature - 293.15)) * 1e-6;
  const double section = std::numbers::pi * std::pow(diameter_, 4) * density_of(air) * dp;
  if (section <= 1e-32) return dp;
  const double lost = 64.0 * length_ * viscosity * mass_flow *
                      (std::sqrt(1.0 + 8.0 * dp / turning) - 1.0) / section;
  return lost >= 1.0 ? dp : dp / (1.0 - lost);
}

double AirspeedReader::pressure_behind(double airspeed, double factor, const Air& air) const {
  if (!(airspeed > 0.0)) return 0.0;
  const double plain = 0.5 * sea_level_density * airspeed * airspeed / (factor * factor);
  if (!flows()) return plain;
  const auto read = [&](double dp) {
    const IndicatedAirspeed one = indicate(dp, air);
    return factor * one.scaled + one.added;
  };
  double low = 0.0;
  double high = plain;
  while (read(high) < airspeed) high *= 2.0;  // a static pressure above the sensor's takes away
  for (int halved = 0; halved < 60; ++halved) {
    const double middle = 0.5 * (low + high);
    (read(middle) < airspeed ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace sepcal::exporting
