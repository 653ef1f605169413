// SPDX-License-Identifier: BSD-3-Clause
// The columns of a five-hole probe: attitude and rates, inertial velocity, the four pressures and
// density (Sun & Gebre-Egziabher, Eqs. 35-41).
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "record_builder.hpp"
#include "sepcal/error.hpp"
#include "sepcal/flight/probe_columns.hpp"

namespace sepcal {
namespace {

constexpr double gas_constant_of_air = 287.05287;  // [J/(kg K)], ISO 2533

constexpr std::array quantities{
    ProbeQuantity{"time", UnitKind::time},    ProbeQuantity{"roll", UnitKind::angle},
    ProbeQuantity{"pitch", UnitKind::angle},  ProbeQuantity{"yaw", UnitKind::angle},
    ProbeQuantity{"p", UnitKind::rate},       ProbeQuantity{"q", UnitKind::rate},
    ProbeQuantity{"r", UnitKind::rate},       ProbeQuantity{"vn", UnitKind::speed},
    ProbeQuantity{"ve", UnitKind::speed},     ProbeQuantity{"vd", UnitKind::speed},
    ProbeQuantity{"pt", UnitKind::pressure},  ProbeQuantity{"ps", UnitKind::pressure},
    ProbeQuantity{"dpa", UnitKind::pressure}, ProbeQuantity{"dpb", UnitKind::pressure},
    ProbeQuantity{"rho", UnitKind::density},  ProbeQuantity{"temp", UnitKind::temperature, true},
};

/// What the probe reads, with the density: needed, valid, and positive.
void need_readings(RecordBuilder& builder, const Flight& flight) {
  builder.need({"pt", "ps", "dpa", "dpb"});
  const bool logged = builder.has({"rho"});
  if (logged) {
    builder.need({"rho"});
  } else if (builder.has({"temp"})) {
    builder.consult({"temp"});
    builder.compute("rho",
                    [ps = builder.logged("ps"), temp = builder.logged("temp")](std::size_t row) {
                      return ps.at(row) / (gas_constant_of_air * temp.at(row));
                    });
  } else {
    throw Error(fmt::format("{}: the density is missing: log rho_kgpm3 or temp_k; {}",
                            flight.name(), flight.list_columns()));
  }
  builder.keep_valid();
  const auto is_positive = [&](std::size_t row) {
    return logged ? builder.logged("rho").at(row) > 0
                  : builder.logged("ps").at(row) > 0 && builder.logged("temp").at(row) > 0;
  };
  builder.keep_or_refuse(is_positive, "the density is not positive", [&](std::size_t) {
    return logged ? "rho is not positive"
                  : "ps or the absolute temperature is not positive, so there is no density";
  });
}

/// Without an excess of total over static pressure there is no airspeed.
RecordBuilder::Loss keep_moving_air(RecordBuilder& builder) {
  return builder.keep([pt = builder.logged("pt"), ps = builder.logged("ps")](
                          std::size_t row) { return pt.at(row) > ps.at(row); },
                      "pt is not above ps");
}

}  // namespace

ProbeRecord prepare_five_hole(const Flight& flight, const FiveHoleColumns& options) {
  RecordBuilder builder(flight, quantities, options.drop_invalid);
  builder.need({"time", "roll", "pitch", "yaw", "vn", "ve", "vd"});
  if (options.lever_arm) builder.need({"p", "q", "r"});
  need_readings(builder, flight);
  builder.check_time();

  const std::size_t candidates = builder.rows().size();
  const auto still = keep_moving_air(builder);
  constexpr std::size_t tolerated = 5;  // an error where more than one row in five is lost
  if (still.rows * tolerated > candidates) {
    throw Error(
        fmt::format("{}: pt is not above ps in {} of {} rows, more than a fifth (the first "
                    "is {}); check the two columns, or cut the log to the flight",
                    flight.name(), still.rows, candidates, flight.locate(still.first)));
  }
  if (!options.lever_arm && !builder.offer({"p", "q", "r"})) {
    for (const char* rate : {"p", "q", "r"}) {
      builder.compute(rate, [](std::size_t) { return 0.0; });
    }
  }
  return builder.finish();
}

ProbeReadings read_five_hole(const Flight& flight, bool drop_invalid) {
  RecordBuilder builder(flight, quantities, drop_invalid);
  need_readings(builder, flight);
  keep_moving_air(builder);
  return builder.finish_readings();
}

}  // namespace sepcal
