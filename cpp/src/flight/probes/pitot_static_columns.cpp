// SPDX-License-Identifier: BSD-3-Clause
// The columns of a plain Pitot-static tube: ground velocity and the airspeed as read, or the
// differential pressure that it comes from, v = sqrt(2 dp / rho).
#include <fmt/format.h>

#include <cmath>

#include "flight/probes/air_columns.hpp"
#include "flight/probes/probe_quantities.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"
#include "sepcal/error.hpp"
#include "sepcal/models/pitot_static.hpp"

namespace sepcal {

using namespace probes;  // this room's own

namespace {

/// A logged airspeed goes before one that would have to be computed.
bool has_airspeed(const RecordBuilder& builder) { return builder.has({"airspeed"}); }

/// The column "airspeed" [m/s] and what it takes: needed, and its rows valid.
void need_airspeed(RecordBuilder& builder, const Flight& flight) {
  if (has_airspeed(builder)) {
    builder.need({"airspeed"});
    builder.keep_valid();
    return;
  }
  if (!builder.has({"dp"})) {
    throw Error(fmt::format(
        "{}: the airspeed is missing: log airspeed_mps, or dp_pa with rho_kgpm3 or "
        "with temp_k and ps_pa{}; {}",
        flight.name(), builder.ask_for_near_miss({"airspeed", "dp"}), flight.list_columns()));
  }
  builder.need({"dp"});
  need_density(builder, flight, "rho_kgpm3, or temp_k and ps_pa, or airspeed_mps instead of dp_pa");
  builder.keep_valid();
  keep_positive_density(builder);
  builder.compute("airspeed",
                  [dp = builder.logged("dp"), density = density_of(builder)](std::size_t row) {
                    return std::sqrt(2.0 * dp.at(row) / density(row));
                  });
}

/// A tube in still air reads noise about zero, or the zero that its driver makes of it.
RecordBuilder::RowTest air_meets_tube(const RecordBuilder& builder) {
  return [reading = builder.logged(has_airspeed(builder) ? "airspeed" : "dp")](std::size_t row) {
    return reading.at(row) > 0;
  };
}

const char* still_in_tube(const RecordBuilder& builder) {
  return has_airspeed(builder) ? "airspeed is not above zero" : "dp is not above zero";
}

}  // namespace

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
      ProbeQuantity{"airspeed", UnitKind::speed},
      ProbeQuantity{"dp", UnitKind::pressure},
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
  need_airspeed(builder, flight);
  builder.check_time();
  keep_moving_air(builder, flight, air_meets_tube(builder), still_in_tube(builder),
                  "check the column, or cut the log to the flight");
  if (has_airspeed(builder)) {
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
  need_airspeed(builder, flight);
  builder.keep(air_meets_tube(builder), still_in_tube(builder));
  if (has_airspeed(builder) && !offer_density(builder)) {
    builder.compute("rho", [](std::size_t) { return PitotStatic::sea_level_density; });
  }
  return builder.finish_readings();
}

}  // namespace sepcal
