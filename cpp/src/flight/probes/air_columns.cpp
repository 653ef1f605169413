// SPDX-License-Identifier: BSD-3-Clause
#include "flight/probes/air_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sepcal/error.hpp"

namespace sepcal::probes {
namespace {

/// Whether the quantity is a number above zero (in the unit used inside) in every kept row.
bool is_positive(const RecordBuilder& builder, std::string_view name) {
  const auto positive = [logged = builder.logged(name)](std::size_t row) {
    return std::isfinite(logged.at(row)) && logged.at(row) > 0;
  };
  return !builder.rows().find_if_not(positive);
}

}  // namespace

double density_of_air(double pressure, double temperature) {
  constexpr double gas_constant = 287.05287;  // [J/(kg K)], ISO 2533
  return pressure / (gas_constant * temperature);
}

RecordBuilder::RowValue density_of(const RecordBuilder& builder) {
  if (builder.has({"rho"})) {
    return [rho = builder.logged("rho")](std::size_t row) { return rho.at(row); };
  }
  return [ps = builder.logged("ps"), temp = builder.logged("temp")](std::size_t row) {
    return density_of_air(ps.at(row), temp.at(row));
  };
}

void need_density(RecordBuilder& builder, const Flight& flight, std::string_view log_what) {
  if (builder.has({"rho"})) {
    builder.need({"rho"});
  } else if (builder.has({"temp", "ps"})) {
    builder.consult({"temp", "ps"});
    builder.compute("rho", density_of(builder));
  } else {
    throw OptionError(files::around(
        fmt::format("{}: the density is missing: log {}", flight.name(), log_what),
        builder.ask_for_near_miss({"rho", "temp", "ps"}), "; " + flight.list_columns()));
  }
}

void keep_positive_density(RecordBuilder& builder) {
  const bool logged = builder.has({"rho"});
  const auto is_positive = [&](std::size_t row) {
    return logged ? builder.logged("rho").at(row) > 0
                  : builder.logged("ps").at(row) > 0 && builder.logged("temp").at(row) > 0;
  };
  builder.keep_or_refuse(is_positive, "the density is not positive", [&](std::size_t) {
    return logged ? "rho is not positive"
                  : "ps or the absolute temperature is not positive, so there is no density";
  });
}

bool offer_density(RecordBuilder& builder) {
  if (builder.has({"rho"})) {
    if (is_positive(builder, "rho")) return builder.offer({"rho"});
    builder.note("the density is not used: it is not a number above zero in every row");
    return false;
  }
  if (!builder.has({"temp", "ps"})) return false;
  if (!is_positive(builder, "temp") || !is_positive(builder, "ps")) return false;
  builder.compute("rho", density_of(builder));
  return true;
}

AirspeedSource choose_airspeed(const RecordBuilder& builder, const Flight& flight,
                               AirspeedSource first) {
  const bool reads = builder.has({"airspeed"});
  const bool has_density = builder.has({"rho"}) || builder.has({"temp", "ps"});
  if (reads && first == AirspeedSource::reading) return AirspeedSource::reading;
  if (builder.has({"dp"}) && (has_density || !reads)) return AirspeedSource::pressure;
  if (reads) return AirspeedSource::reading;
  throw OptionError(files::around(
      fmt::format("{}: the airspeed is missing: log airspeed_mps, or dp_pa with rho_kgpm3 or "
                  "with temp_k and ps_pa",
                  flight.name()),
      builder.ask_for_near_miss({"airspeed", "dp"}), "; " + flight.list_columns()));
}

void need_airspeed(RecordBuilder& builder, const Flight& flight, AirspeedSource source) {
  if (source == AirspeedSource::reading) {
    builder.need({"airspeed"});
    builder.keep_valid();
    return;
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

RecordBuilder::RowTest air_meets_tube(const RecordBuilder& builder, AirspeedSource source) {
  const bool reads = source == AirspeedSource::reading;
  return [reading = builder.logged(reads ? "airspeed" : "dp")](std::size_t row) {
    return reading.at(row) > 0;
  };
}

const char* still_in_tube(AirspeedSource source) {
  return source == AirspeedSource::reading ? "airspeed is not above zero" : "dp is not above zero";
}

void zero_rates(RecordBuilder& builder) {
  for (const char* rate : {"p", "q", "r"}) {
    builder.compute(rate, [](std::size_t) { return 0.0; });
  }
}

void offer_temperature(RecordBuilder& builder) {
  if (!builder.has({"temp"}) || !is_positive(builder, "temp")) return;
  builder.compute("temperature",
                  [temp = builder.logged("temp")](std::size_t row) { return temp.at(row); });
}

void keep_moving_air(RecordBuilder& builder, const Flight& flight,
                     const RecordBuilder::RowTest& moves, std::string_view reason,
                     std::string_view check_what) {
  const std::size_t candidates = builder.rows().size();
  const auto still = builder.keep(moves, reason);
  constexpr std::size_t tolerated = 5;  // an error where more than one row in five is lost
  if (still.rows * tolerated <= candidates) return;
  throw Error(fmt::format("{}: {} in {} of {} rows, more than a fifth (the first is {}); {}",
                          flight.name(), reason, still.rows, candidates, flight.locate(still.first),
                          check_what));
}

}  // namespace sepcal::probes
