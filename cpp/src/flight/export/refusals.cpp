// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/refusals.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>

#include "flight/export/exporter.hpp"
#include "flight/export/held.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/effect_name.hpp"
#include "sepcal/error.hpp"

namespace sepcal::exporting {

bool is_header(ExportTarget target) {
  return target == ExportTarget::c || target == ExportTarget::cpp;
}

Calibration of_one_flight(const Calibration& calibration, const Flight* flight,
                          const ExportOptions& options) {
  const JointSetup* const joint = joint_setup(*calibration.probe);
  if (joint == nullptr) return calibration;
  const auto files = joint->flights | std::views::transform(&JoinedFlight::file);
  const bool keeps = is_magnetometer(calibration) && options.rotation != ExportRotation::refit;
  const bool fits_anew = !is_header(options.target) && !keeps;
  if (fits_anew || !options.without.empty()) {
    throw Error(fmt::format(
        "the calibration is of {} flights jointly, and what is fitted anew is of one: fit one of "
        "them alone and export that: {}",
        joint->flights.size(), fmt::join(files, ", ")));
  }
  const Calibration one = flight == nullptr ? calibration : for_flight(calibration, *flight);
  if (joint_setup(*one.probe) == nullptr) return one;
  throw Error(
      fmt::format("the calibration is of {} flights; give the one whose own values are "
                  "wanted after it: {}",
                  joint->flights.size(), fmt::join(files, ", ")));
}

void check_without(const Calibration& calibration, const std::vector<std::string>& names) {
  std::vector<std::string> effects;
  for (const EffectSetting& one : calibration.options.effects) effects.push_back(one.name);
  for (const std::string& name : names) {
    if (std::ranges::find(effects, name) != effects.end()) continue;
    throw OptionError(
        {Option{"without"},
         fmt::format(" {}: the calibration has no such effect; it has {}", name,
                     effects.empty() ? "none" : fmt::format("{}", fmt::join(effects, ", ")))});
  }
}

void refuse_overflow(const Calibration& calibration) {
  constexpr auto most = static_cast<double>(std::numeric_limits<float>::max());
  for (const EffectSetting& setting : calibration.options.effects) {
    const EffectName name = parse_effect_name(setting.name);
    const auto range = calibration.driver_ranges.find(name.base);
    if (name.shape != EffectName::Shape::power || range == calibration.driver_ranges.end())
      continue;
    const double centre = setting.centre.value_or(0.0);
    const double reach =
        std::max(std::abs(range->second.lower - centre), std::abs(range->second.upper - centre));
    const double power = std::pow(reach, name.number);
    if (power <= most) continue;
    throw Error(
        fmt::format("{}: its power reaches {:.2g} on the flight, beyond what a float holds; export "
                    "it in double",
                    setting.name, power));
  }
}

void refuse_homeless(const Calibration& calibration, const ExportOptions& options) {
  const Exporter& exporter = exporter_of(calibration);
  if (is_header(options.target) || exporter.held != HeldAs::nothing) return;
  throw OptionError({std::string(exporter.instrument) + " has no home in " +
                         (options.target == ExportTarget::px4 ? "PX4" : "ArduPilot") +
                         ", which knows no flow angles; ",
                     Option{"to"}, " c or cpp holds all of it"});
}

void refuse_idle(const Calibration& calibration, const ExportOptions& options) {
  const bool px4_field = options.target == ExportTarget::px4 && is_magnetometer(calibration);
  const bool airspeed =
      !is_header(options.target) && exporter_of(calibration).held == HeldAs::airspeed;
  const auto idle = [](const char* option, const std::string& of) {
    throw OptionError({Option{option}, " is of " + of + "; leave it out"});
  };
  const bool px4_airspeed = airspeed && options.target == ExportTarget::px4;
  if (options.device_id && !px4_field && !px4_airspeed) idle("device_id", "PX4's sensors");
  if (options.mounting && !px4_field) idle("mounting", "PX4's magnetometers");
  if (options.single && !is_header(options.target)) idle("single", "a header, c or cpp");
  if (options.in_use && !airspeed) idle("in_use", "an autopilot's airspeed");
  if (options.airspeed_sensor && !airspeed) idle("airspeed_sensor", "an autopilot's airspeed");
  if (options.cal_air && !px4_airspeed) idle("cal_air", "PX4's airspeed");
  if (options.logged_airspeed != LoggedAirspeed::true_airspeed && !airspeed) {
    idle("logged_airspeed", "an autopilot's airspeed");
  }
  if (options.rotation && (is_header(options.target) || !is_of_known_field(calibration))) {
    idle("rotation", "a magnetometer in a known field, for an autopilot");
  }
  if (options.in_use && !(std::isfinite(*options.in_use) && *options.in_use > 0)) {
    throw OptionError({Option{"in_use"}, fmt::format(" is {}; give the ratio or the scale, above "
                                                     "zero",
                                                     *options.in_use)});
  }
}

}  // namespace sepcal::exporting
