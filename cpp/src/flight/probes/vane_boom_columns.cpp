// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/vane_boom_columns.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "flight/probes/air_columns.hpp"
#include "sepcal/models/vane_boom.hpp"

namespace sepcal::probes {
namespace {

/// What the boom reads: needed, and its rows valid. Returns where the airspeed comes from.
AirspeedSource need_boom_readings(RecordBuilder& builder, const Flight& flight) {
  const AirspeedSource source = choose_airspeed(builder, flight, AirspeedSource::pressure);
  builder.need({"alpha", "beta"});
  need_airspeed(builder, flight, source);
  if (source == AirspeedSource::pressure && builder.has({"airspeed"})) {
    builder.note(fmt::format("column '{}' is not used: the airspeed is that of {} and the density",
                             builder.logged("airspeed").column->header,
                             builder.logged("dp").column->header));
  }
  return source;
}

/// What a vane in the air that it is made for can read.
RecordBuilder::RowTest vanes_point_ahead(const RecordBuilder& builder) {
  return [alpha = builder.logged("alpha"), beta = builder.logged("beta")](std::size_t row) {
    constexpr double quarter = std::numbers::pi / 2;
    return std::abs(alpha.at(row)) < quarter && std::abs(beta.at(row)) < quarter;
  };
}

constexpr const char* beyond_the_vanes = "alpha or beta is beyond +-90 deg";

}  // namespace

std::span<const ProbeQuantity> vane_boom_quantities() {
  using files::UnitKind;
  static constexpr std::array quantities{
      ProbeQuantity{"time", UnitKind::time},
      ProbeQuantity{"roll", UnitKind::angle},
      ProbeQuantity{"pitch", UnitKind::angle},
      ProbeQuantity{"yaw", UnitKind::angle},
      ProbeQuantity{"p", UnitKind::rate},
      ProbeQuantity{"q", UnitKind::rate},
      ProbeQuantity{"r", UnitKind::rate},
      ProbeQuantity{"vn", UnitKind::speed},
      ProbeQuantity{"ve", UnitKind::speed},
      ProbeQuantity{"vd", UnitKind::speed},
      ProbeQuantity{.name = "alpha", .kind = UnitKind::angle, .is_measured = true},
      ProbeQuantity{.name = "beta", .kind = UnitKind::angle, .is_measured = true},
      ProbeQuantity{"airspeed", UnitKind::speed},
      ProbeQuantity{"dp", UnitKind::pressure},
      ProbeQuantity{.name = "ps", .kind = UnitKind::pressure, .unless = {"rho"}},
      ProbeQuantity{"rho", UnitKind::density},
      ProbeQuantity{
          .name = "temp", .kind = UnitKind::temperature, .is_driver = true, .unless = {"rho"}},
  };
  return quantities;
}

ProbeRecord prepare_vane_boom(const Flight& flight, bool lever_arm, const LogChoice& log) {
  RecordBuilder builder(flight, vane_boom_quantities(), log);
  builder.need({"time", "roll", "pitch", "yaw", "vn", "ve", "vd"});
  if (lever_arm) builder.need({"p", "q", "r"});
  const AirspeedSource source = need_boom_readings(builder, flight);
  builder.check_time();
  keep_moving_air(builder, flight, air_meets_tube(builder, source), still_in_tube(source),
                  "check the column, or cut the log to the flight");
  keep_moving_air(builder, flight, vanes_point_ahead(builder), beyond_the_vanes,
                  "check the columns and their units, or cut the log to the flight");
  if (!lever_arm && !builder.offer({"p", "q", "r"})) zero_rates(builder);
  if (source == AirspeedSource::reading) offer_density(builder);
  builder.offer({"ps"});
  offer_temperature(builder);
  return builder.finish();
}

ProbeReadings read_vane_boom(const Flight& flight, const LogChoice& log) {
  RecordBuilder builder(flight, vane_boom_quantities(), log);
  const AirspeedSource source = need_boom_readings(builder, flight);
  builder.keep(air_meets_tube(builder, source), still_in_tube(source));
  builder.keep(vanes_point_ahead(builder), beyond_the_vanes);
  if (source == AirspeedSource::reading && !offer_density(builder)) {
    builder.compute("rho", [](std::size_t) { return VaneBoom::sea_level_density; });
  }
  return builder.finish_readings();
}

}  // namespace sepcal::probes
