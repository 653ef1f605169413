// SPDX-License-Identifier: BSD-3-Clause
// From a flight as it was logged to the record that a probe's model takes: columns found by
// quantity and converted, bad rows refused or dropped and counted, the rest cut into segments.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sepcal/detail/flight/log_choice.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// Rows that were left out, and why.
struct Dropped {
  std::string reason;  // "a cell of a needed column is no finite number"
  std::size_t rows = 0;
};

/// What a fit takes. The record's columns are the probe's quantities by their base name, in SI with
/// fields in uT ("time", "roll", "pt"), and every other numeric column of the flight under its
/// whole header and as it stands ("altitude_m"): a candidate driver of missing effects.
struct ProbeRecord {
  Record record;                         // cut at gaps and changes of maneuver
  std::size_t rows_read = 0;             // rows of the flight
  std::vector<Dropped> dropped;          // only reasons that a row was dropped for
  std::vector<std::string> notes;        // one line each, for people
  std::vector<std::size_t> flight_rows;  // the flight's row of each row of the record

  std::size_t rows_used() const { return record.length(); }
};

/// What applying a calibration takes: every row of the flight, whatever its worth.
struct ProbeReadings {
  Record record;            // only the columns that the probe reads; one segment
  std::vector<bool> valid;  // a row each; false: there is nothing to calibrate
  std::vector<Dropped> dropped;
  std::vector<std::string> notes;
};

struct FiveHoleColumns {
  bool lever_arm = false;  // a lever arm is given, so the body rates are needed
  LogChoice log = {};
  double k_alpha = 0.0;  // sensitivity of the flow-angle ports [1/rad]; 0: not known
  double k_beta = 0.0;
};

/// time [s]; roll, pitch, yaw [rad]; p, q, r [rad/s]; vn, ve, vd [m/s]; pt, ps, dpa, dpb [Pa]; rho
/// [kg/m^3], from rho_kgpm3 or else ps / (287.05287 T). The rates are zeros where they are not
/// needed and not logged. Rows with pt <= ps are dropped. For effects also alpha and beta [rad],
/// the flow angles as read, where the sensitivities are known, and temperature [K] where temp is
/// logged. Throws Error for a missing column, an unknown unit on one of these quantities or on
/// temp, a quantity logged in two units, a cell of a needed column that is no finite number or a
/// density
/// <= 0 (unless drop_invalid), a column of drop_repeats that is not there, time that does not
/// increase, pt <= ps in more than a fifth of the rows, and a flight of which no row is left.
ProbeRecord prepare_five_hole(const Flight& flight, const FiveHoleColumns& options = {});

/// pt, ps, dpa, dpb [Pa] and rho [kg/m^3] of every row; pt <= ps makes a row not valid. Throws
/// Error as prepare_five_hole() does, but for pt <= ps.
ProbeReadings read_five_hole(const Flight& flight, const LogChoice& log = {});

/// time [s]; vn, ve, vd [m/s]; airspeed [m/s] as read, from airspeed_mps or else sqrt(2 dp / rho),
/// rho as above. For effects also rho, dp, ps, attitude, rates and temperature [K], where they are
/// logged or can be computed in every row. Rows with a reading that is not above zero are dropped.
/// Throws Error as prepare_five_hole() does, and where neither way to the airspeed is there.
ProbeRecord prepare_pitot_static(const Flight& flight, const LogChoice& log = {});

/// airspeed [m/s] and rho [kg/m^3] of every row, rho that of the sea level (1.225) where it can't
/// be had in every row that counts; a row where it is not above zero is not valid. Throws Error as
/// prepare_pitot_static() does for these columns.
ProbeReadings read_pitot_static(const Flight& flight, const LogChoice& log = {});

/// Roll, pitch and yaw [deg] by which a sensor is turned against the body: m_body = R m_sensor, R
/// the 3-2-1 sequence of docs/notation.md from the sensor's axes to the body's.
using Mounting = std::array<double, 3>;

struct MagnetometerColumns {
  std::optional<std::array<double, 3>> field;  // north, east, down [uT]: instead of logged columns
  LogChoice log = {};
  Mounting mounting = {};
};

/// time [s]; mx, my, mz [uT], turned into body axes where the sensor is mounted otherwise; hx, hy,
/// hz [uT], the true field in body axes: logged, or from roll,
/// pitch, yaw [rad] and the field bn, be, bd [uT], logged or given (then it replaces logged
/// columns, with a note). What of attitude, rates p, q, r [rad/s] and bn, be, bd is there is kept
/// as well. Throws Error as prepare_five_hole() does, and where none of these ways to the true
/// field is there.
ProbeRecord prepare_magnetometer(const Flight& flight, const MagnetometerColumns& options = {});

/// time [s]; mx, my, mz [uT]; field [uT], zero in every row: what the attitude-independent model
/// measures; and, where the field's strength is logged, field_change [uT], what it is more than
/// `field_strength` [uT]. The field and the attitude are not looked at, though they may be there.
ProbeRecord prepare_attitude_independent(const Flight& flight, double field_strength,
                                         const LogChoice& log = {});

/// mx, my, mz [uT] of every row, turned likewise. Throws Error as prepare_magnetometer() does for
/// these columns.
ProbeReadings read_magnetometer(const Flight& flight, const LogChoice& log = {},
                                const Mounting& mounting = {});

}  // namespace sepcal
