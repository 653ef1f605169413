// SPDX-License-Identifier: BSD-3-Clause
// What an autopilot can hold of a Pitot-static tube: a factor on the airspeed that it reads, and an
// offset of the pressure. Both are fitted anew to the readings as this autopilot makes them.
#pragma once

#include <span>
#include <vector>

#include "flight/export/airspeed_reader.hpp"
#include "flight/verbs/prepared_flight.hpp"

namespace sepcal::exporting {

/// The equivalent airspeed is factor * scaled + added of dp - offset (airspeed_reader.hpp).
struct HeldAirspeed {
  double factor = 1.0;
  double offset = 0.0;  // Pa
};

/// What a row of a flight says of the sensor.
struct TubeRow {
  double dp = 0.0;       // across the sensor [Pa]
  double density = 0.0;  // [kg/m^3], behind the true airspeed
  Air air = {};
};

/// How a tube's flight is read.
struct TubeReader {
  AirspeedReader sensor = {};
  double in_use = 1.0;        // the factor that a logged airspeed was read with
  bool has_airspeed = false;  // the reading is a logged airspeed, not a pressure
  LoggedAirspeed logged = LoggedAirspeed::true_airspeed;
  bool has_offset = true;  // whether the autopilot keeps an offset of the pressure
};

/// A row each of `record`, which has the airspeed [m/s] and the density [kg/m^3] as the probe reads
/// them, row i that of flight_rows[i]. Throws Error where the reader needs a density, a static
/// pressure or a temperature and the flight has none.
std::vector<TubeRow> tube_rows(const TubeReader& reader, const Flight& flight, const Record& record,
                               std::span<const std::size_t> flight_rows);

/// The true airspeed [m/s] that the autopilot makes of a row.
double corrected(const HeldAirspeed& held, const AirspeedReader& sensor, const TubeRow& row);

struct FittedAirspeed {
  HeldAirspeed held;
  Calibration calibration;         // of the readings as the autopilot makes them
  verbs::PreparedFlight prepared;  // with these readings
};

/// The best that is held, on a flight. Throws Error as a fit does, and where the fits do not
/// settle.
FittedAirspeed fit_airspeed(const Calibration& calibration, const Flight& flight,
                            const TubeReader& reader, const ExportOptions& options);

}  // namespace sepcal::exporting
