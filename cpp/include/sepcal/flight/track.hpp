// SPDX-License-Identifier: BSD-3-Clause
// A flight followed row by row, as a filter on the vehicle would follow it: from a mini-batch of
// its first rows, or from the calibration of another flight.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sepcal/detail/flight/output_file.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/states/track.hpp"

namespace sepcal {

struct FlightTrackOptions {
  TrackOptions how = {};  // its noise is that of the first rows too
  /// Stages one and two on so many first rows, and on after them; 0: from the calibration of
  /// another flight.
  std::size_t start_rows = 0;
  /// Of a probe: parameters of this flight alone, as a "wind" (w_n, w_e, w_d), whose size the first
  /// rows tell; all others begin as the calibration has them, of another flight, and every row is
  /// followed. Empty: the first rows alone tell all.
  std::vector<std::string> own = {};
  /// Of two steps: how the second follows the coefficients; `how` is of the path then, but for its
  /// forgetting, memory, band and changes, and walks of coefficients, which are the second's.
  TrackMethod second = TrackMethod::rls;
};

/// Estimates against time along a flight.
struct TrackedFlight {
  Track track;                                // rows of its changes are the flight's
  std::vector<Variable> table;                // of track.names, with units
  std::vector<Variable> outputs;              // n_z
  std::vector<std::size_t> flight_rows = {};  // of track.rows
  std::string file = {};                      // the flight's
  std::vector<std::string> notes = {};
};

/// A probe's parameters, and those of its effects. Throws Error as track() and compare() do, for a
/// model with a state, for process noise and states, which a probe has not, and where the flight is
/// the file of the calibration, whose rows must not count twice.
TrackedFlight track(const Calibration& calibration, const Flight& flight,
                    const FlightTrackOptions& options = {});

/// Writes time_s, every estimate with its standard deviation (`b_ax_mps2`, `b_ax_sd_mps2`) and the
/// innovations (`alpha_innovation_rad`); a row an estimate.
void write_csv(const TrackedFlight& tracked, OutputFile& target);

std::string to_text(const TrackedFlight& tracked, Detail detail = Detail::brief);
std::string to_json(const TrackedFlight& tracked);

}  // namespace sepcal
