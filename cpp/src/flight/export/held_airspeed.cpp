// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/held_airspeed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "flight/export/held.hpp"
#include "flight/export/parameters.hpp"
#include "flight/files/headers.hpp"
#include "flight/probes/air_columns.hpp"
#include "sepcal/error.hpp"

namespace sepcal::exporting {
namespace {

constexpr const char* zero_of_tube = "pressure_offset";  // Pa

/// The static pressure and the temperature of a flight's rows; one of them from the density.
class LoggedAir {
 public:
  explicit LoggedAir(const Flight& flight)
      : flight_(flight),
        pressure_(files::read_quantity(flight, "ps", files::UnitKind::pressure)),
        temperature_(files::read_quantity(flight, "temp", files::UnitKind::temperature)) {}

  Air at(std::size_t row, double density) const {
    Air air;
    if (pressure_.empty() && temperature_.empty()) refuse("neither is logged");
    air.pressure = pressure_.empty() ? 0.0 : pressure_[row];
    air.temperature = temperature_.empty() ? 0.0 : temperature_[row];
    const double unit = probes::density_of_air(1.0, 1.0);  // of 1 Pa at 1 K
    if (pressure_.empty()) air.pressure = density / unit * air.temperature;
    if (temperature_.empty()) air.temperature = unit / density * air.pressure;
    if (!(air.pressure > 0.0) || !(air.temperature > 0.0) || !std::isfinite(air.pressure) ||
        !std::isfinite(air.temperature)) {
      refuse(fmt::format("{} has none", flight_.locate(row)));
    }
    return air;
  }

 private:
  [[noreturn]] void refuse(const std::string& why) const {
    throw Error(fmt::format(
        "{}: an SDP3x is corrected by the static pressure and the air's temperature, and {}; log "
        "ps_pa and temp_degc, or one of them and rho_kgpm3",
        flight_.name(), why));
  }

  const Flight& flight_;
  std::vector<double> pressure_;
  std::vector<double> temperature_;
};

double root_of_densities(double density) { return std::sqrt(sea_level_density / density); }

/// The reading that a straight line with the held factor makes the true airspeed of.
double reading_of(const HeldAirspeed& held, const AirspeedReader& sensor, const TubeRow& row) {
  const IndicatedAirspeed one = sensor.indicate(row.dp - held.offset, row.air);
  return (one.scaled + one.added / held.factor) * root_of_densities(row.density);
}

/// How much more pressure the readings show for a Pascal more at the sensor: 1 of a membrane.
double gain_of(const HeldAirspeed& held, const AirspeedReader& sensor,
               const std::vector<TubeRow>& rows) {
  constexpr double step = 0.1;  // Pa
  const HeldAirspeed above{held.factor, held.offset - step};
  double sum = 0.0;
  for (const TubeRow& row : rows) {
    const double low = reading_of(held, sensor, row);
    const double high = reading_of(above, sensor, row);
    sum += 0.5 * row.density * (high * high - low * low) / step;
  }
  return sum / static_cast<double>(rows.size());
}

bool is_held_at(const CalibrationOptions& options, const std::string& parameter) {
  return options.fit.fix.contains(parameter) || options.fit.prior.contains(parameter);
}

/// Options for a tube without c_va, with an offset of the pressure where one is kept.
CalibrationOptions held_options(const Calibration& calibration, const TubeReader& reader,
                                const ExportOptions& options) {
  CalibrationOptions held = options_without(calibration, {}, options.progress);
  const auto is_zero = [](const EffectSetting& one) { return one.name == zero_of_tube; };
  const bool has_zero = std::ranges::any_of(held.effects, is_zero);
  const std::string offset = std::string(zero_of_tube) + ".s";
  if (has_zero && !reader.has_offset) {
    throw OptionError(
        {"ArduPilot sets an SDP3x's offset to zero, so that it can't hold "
         "pressure_offset; ",
         Option{"without"}, " pressure_offset fits the rest anew"});
  }
  if (has_zero && reader.sensor.flows() && is_held_at(held, offset)) {
    throw OptionError(
        {"pressure_offset is held by the fit, and behind an SDP3x it is another "
         "pressure; ",
         Option{"without"}, " pressure_offset finds it anew"});
  }
  if (!has_zero && reader.has_offset) held.effects.push_back({.name = zero_of_tube});
  forget("c_va", held.fit);
  std::erase(held.free, "c_va");
  held.fit.fix["c_va"] = 0.0;
  return held;
}

/// Puts the readings as the autopilot makes them in the place of those that were fitted.
void read_by(const HeldAirspeed& held, const AirspeedReader& sensor,
             const std::vector<TubeRow>& rows, Record& record) {
  std::vector<double> airspeed;
  airspeed.reserve(rows.size());
  for (const TubeRow& row : rows) airspeed.push_back(reading_of(held, sensor, row));
  record.replace("airspeed", std::move(airspeed));
}

/// What a fit of the readings leaves for the offset [Pa], as the readings have it.
double offset_left(const Calibration& calibration, bool has_offset) {
  if (!has_offset) return 0.0;
  const double s = calibration.fit["s_va"].value;
  return -calibration.fit[std::string(zero_of_tube) + ".s"].value * s * s;
}

}  // namespace

std::vector<TubeRow> tube_rows(const TubeReader& reader, const Flight& flight, const Record& record,
                               std::span<const std::size_t> flight_rows) {
  const bool is_true = reader.logged == LoggedAirspeed::true_airspeed;
  if (!record.has("rho") && !is_true) {
    throw Error(fmt::format(
        "{}: of an equivalent airspeed the density makes the true one, and none is known in every "
        "row; log rho_kgpm3, or ps_pa and temp_degc",
        flight.name()));
  }
  const LoggedAir air(flight);
  const std::span<const double> airspeed = record.column("airspeed");
  std::vector<TubeRow> rows(airspeed.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    TubeRow& row = rows[i];
    row.density = record.has("rho") ? record.column("rho")[i] : sea_level_density;
    if (reader.sensor.flows()) row.air = air.at(flight_rows[i], row.density);
    if (!reader.has_airspeed) {
      row.dp = 0.5 * row.density * airspeed[i] * airspeed[i];
      continue;
    }
    const double equivalent = is_true ? airspeed[i] / root_of_densities(row.density) : airspeed[i];
    row.dp = reader.sensor.pressure_behind(equivalent, reader.in_use, row.air);
  }
  return rows;
}

double corrected(const HeldAirspeed& held, const AirspeedReader& sensor, const TubeRow& row) {
  return held.factor * reading_of(held, sensor, row);
}

FittedAirspeed fit_airspeed(const Calibration& calibration, const Flight& flight,
                            const TubeReader& reader, const ExportOptions& options) {
  constexpr int most_fits = 40;
  constexpr double settled_offset = 1e-4;  // Pa
  constexpr double settled_factor = 1e-8;
  FittedAirspeed fitted{{}, calibration, verbs::prepare(calibration, flight)};
  const ProbeRecord& readings = fitted.prepared.readings;
  const std::vector<TubeRow> rows =
      tube_rows(reader, fitted.prepared.flight, readings.record, readings.flight_rows);
  CalibrationOptions held_by = held_options(calibration, reader, options);
  keep_known(calibration.probe->model().tables(), held_by);
  HeldAirspeed& held = fitted.held;
  double gain = gain_of(held, reader.sensor, rows);
  double left_before = not_a_number;
  double step = not_a_number;
  for (int fit = 0; fit < most_fits; ++fit) {
    read_by(held, reader.sensor, rows, fitted.prepared.readings.record);
    fitted.calibration = verbs::calibrate(calibration.probe, fitted.prepared, held_by);
    const double factor = 1.0 / fitted.calibration.fit["s_va"].value;
    const double left = offset_left(fitted.calibration, reader.has_offset);
    if (!reader.sensor.flows()) {  // an offset of the readings' pressure is that of the sensor's
      held = {factor, left};
      return fitted;
    }
    const bool settled = std::abs(left) < settled_offset &&
                         std::abs(factor - held.factor) < settled_factor * std::abs(factor);
    if (left != left_before && std::isfinite(left_before)) gain = (left_before - left) / step;
    left_before = left;
    step = left / gain;
    held = {factor, held.offset + step};
    if (settled) return fitted;
  }
  throw Error(
      "the airspeed of an SDP3x and its offset do not settle when fitted in turn; fit a flight "
      "with more airspeeds");
}

}  // namespace sepcal::exporting
