// SPDX-License-Identifier: BSD-3-Clause
// The columns of a five-hole probe: attitude and rates, inertial velocity, the four pressures and
// density (Sun & Gebre-Egziabher, Eqs. 35-41).
#include "flight/probes/air_columns.hpp"
#include "flight/probes/probe_quantities.hpp"
#include "flight/probes/record_builder.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"

namespace sepcal {

using namespace probes;  // this room's own

namespace {

/// What the probe reads, with the density: needed, valid, and positive.
void need_readings(RecordBuilder& builder, const Flight& flight) {
  builder.need({"pt", "ps", "dpa", "dpb"});
  need_density(builder, flight, "rho_kgpm3 or temp_k");
  builder.keep_valid();
  keep_positive_density(builder);
}

/// Without an excess of total over static pressure there is no airspeed.
RecordBuilder::RowTest air_moves(const RecordBuilder& builder) {
  return [pt = builder.logged("pt"), ps = builder.logged("ps")](std::size_t row) {
    return pt.at(row) > ps.at(row);
  };
}

constexpr const char* still_air = "pt is not above ps";

/// A flow angle as read [rad], a state function for effects.
void compute_angle(RecordBuilder& builder, const char* name, const char* port, double k) {
  if (!(k > 0)) return;
  builder.compute(
      name, [k, dp = builder.logged(port), pt = builder.logged("pt"), ps = builder.logged("ps")](
                std::size_t row) { return dp.at(row) / (k * (pt.at(row) - ps.at(row))); });
}

}  // namespace

std::span<const ProbeQuantity> probes::five_hole_quantities() {
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
      ProbeQuantity{.name = "pt", .kind = UnitKind::pressure, .is_measured = true},
      ProbeQuantity{.name = "ps", .kind = UnitKind::pressure, .is_measured = true},
      ProbeQuantity{.name = "dpa", .kind = UnitKind::pressure, .is_measured = true},
      ProbeQuantity{.name = "dpb", .kind = UnitKind::pressure, .is_measured = true},
      ProbeQuantity{"rho", UnitKind::density},
      ProbeQuantity{
          .name = "temp", .kind = UnitKind::temperature, .is_driver = true, .unless = {"rho"}},
  };
  return quantities;
}

ProbeRecord prepare_five_hole(const Flight& flight, const FiveHoleColumns& options) {
  RecordBuilder builder(flight, five_hole_quantities(), options.log);
  builder.need({"time", "roll", "pitch", "yaw", "vn", "ve", "vd"});
  if (options.lever_arm) builder.need({"p", "q", "r"});
  need_readings(builder, flight);
  builder.check_time();
  keep_moving_air(builder, flight, air_moves(builder), still_air,
                  "check the two columns, or cut the log to the flight");
  if (!options.lever_arm && !builder.offer({"p", "q", "r"})) zero_rates(builder);
  compute_angle(builder, "alpha", "dpa", options.k_alpha);
  compute_angle(builder, "beta", "dpb", options.k_beta);
  offer_temperature(builder);
  return builder.finish();
}

ProbeReadings read_five_hole(const Flight& flight, const LogChoice& log) {
  RecordBuilder builder(flight, five_hole_quantities(), log);
  need_readings(builder, flight);
  builder.keep(air_moves(builder), still_air);
  return builder.finish_readings();
}

}  // namespace sepcal
