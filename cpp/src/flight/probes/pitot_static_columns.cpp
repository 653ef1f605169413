// SPDX-License-Identifier: BSD-3-Clause
// The columns of a plain Pitot-static tube: ground velocity and the airspeed as read, or the
// differential pressure that it comes from, v = sqrt(2 dp / rho).
#include "flight/probes/air_columns.hpp"
#include "flight/probes/probe_quantities.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"
#include "sepcal/models/pitot_static.hpp"

namespace sepcal {

using namespace probes;  // this room's own

std::span<const ProbeQuantity> probes::pitot_static_quantities() {
  using files::UnitKind;
  static constexpr std::array quantities{
      ProbeQuantity{"time", UnitKind::time},
      ProbeQuantity{"roll", UnitKind::angle, false, true},
      ProbeQuantity{"pitch", UnitKind::angle, false, true},
      ProbeQuantity{"yaw", UnitKind::angle, false, true},
      ProbeQuantity{"p", UnitKind::rate, false, true},
      ProbeQuantity{"q", UnitKind::rate, false, true},
      ProbeQuantity{"r", UnitKind::rate, false, true},
      ProbeQuantity{"vn", UnitKind::speed},
      ProbeQuantity{"ve", UnitKind::speed},
      ProbeQuantity{"vd", UnitKind::speed},
      ProbeQuantity{.name = "airspeed", .kind = UnitKind::speed, .is_measured = true},
      ProbeQuantity{.name = "dp", .kind = UnitKind::pressure, .is_measured = true},
      ProbeQuantity{.name = "ps", .kind = UnitKind::pressure, .unless = {"airspeed", "rho"}},
      ProbeQuantity{.name = "rho", .kind = UnitKind::density, .unless = {"airspeed"}},
      ProbeQuantity{.name = "temp",
                    .kind = UnitKind::temperature,
                    .is_driver = true,
                    .unless = {"airspeed", "rho"}},
  };
  return quantities;
}

ProbeRecord prepare_pitot_static(const Flight& flight, const LogChoice& log) {
  RecordBuilder builder(flight, pitot_static_quantities(), log);
  builder.need({"time", "vn", "ve", "vd"});
  const AirspeedSource source = choose_airspeed(builder, flight, AirspeedSource::reading);
  need_airspeed(builder, flight, source);
  builder.check_time();
  keep_moving_air(builder, flight, air_meets_tube(builder, source), still_in_tube(source),
                  "check the column, or cut the log to the flight");
  if (source == AirspeedSource::reading) {
    offer_density(builder);
    builder.offer({"dp"});
  }
  builder.offer({"ps"});
  builder.offer({"roll", "pitch", "yaw"});
  builder.offer({"p", "q", "r"});
  offer_temperature(builder);
  return builder.finish();
}

ProbeReadings read_pitot_static(const Flight& flight, const LogChoice& log) {
  RecordBuilder builder(flight, pitot_static_quantities(), log);
  const AirspeedSource source = choose_airspeed(builder, flight, AirspeedSource::reading);
  need_airspeed(builder, flight, source);
  builder.keep(air_meets_tube(builder, source), still_in_tube(source));
  if (source == AirspeedSource::reading && !offer_density(builder)) {
    builder.compute("rho", [](std::size_t) { return PitotStatic::sea_level_density; });
  }
  return builder.finish_readings();
}

}  // namespace sepcal
