// SPDX-License-Identifier: BSD-3-Clause
// From an aircraft's log to the record that its models take.
#pragma once

#include <string>
#include <vector>

#include "flight/probes/quantities.hpp"
#include "sepcal/detail/flight/probe_columns.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal::aircraft_log {

/// What its models read of a log, needed or not.
probes::ModelQuantities quantities_of(AircraftModel model);

/// Whether the model flies in the plane of symmetry: longitudinal, or CX, CZ and Cm alone.
bool is_symmetric(AircraftModel model, const std::vector<AeroEquation>& equations);

/// An output that the log has in some rows alone.
struct GappedOutput {
  std::string name;
  std::vector<double> values;  // a row of the record each, NaN where there is none
};

/// What a fit asks of a log.
struct AskedColumns {
  AircraftModel model;
  bool symmetric = false;  // ay, p, r, beta and roll are zero where they are not logged
  bool position = false;   // north, east, down too, of lat, lon and altitude where these are logged
};

/// Of two steps: as of a model with a state, which the path has.
AskedColumns two_step_columns(const AircraftOptions& path);

/// Whether prepare() would list gaps.
bool has_gaps(const Flight& flight, const AskedColumns& asked, const LogChoice& log);

/// time [s]; ax ay az [m/s^2]; p q r [rad/s]; of an aircraft airspeed [m/s], alpha and beta [rad],
/// rho [kg/m^3] or qbar [Pa]; and whatever else of the models' columns is logged. Throws Error as
/// prepare_five_hole() does, and for a load factor in place of az. What stands in for columns a
/// note says. `gaps`: outputs with empty cells are kept, in the record with straight lines in
/// these, and listed there; else they ask for --drop-invalid, or are left out.
ProbeRecord prepare(const Flight& flight, const AskedColumns& asked, const LogChoice& log,
                    std::vector<GappedOutput>* gaps = nullptr);

}  // namespace sepcal::aircraft_log
