// SPDX-License-Identifier: BSD-3-Clause
// Several flights of one probe, calibrated together: some parameters are each flight's own (a wind
// a flight), the others are shared. The flights are joined to one, and the probe's model gets each
// own parameter once a flight, so that everything that takes a flight and a probe takes these.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/flight/probe.hpp"

namespace sepcal {

/// One of the flights that were joined.
struct JoinedFlight {
  std::string label;  // "monday": what its own parameters are called by, "w_n@monday"
  std::string file;
  std::string sha256;  // of the file's bytes; of arrays empty
  std::size_t rows = 0;
};

/// What a joint calibration is of.
struct JointSetup {
  std::vector<std::string> own;  // parameters of the probe, in its order
  std::vector<JoinedFlight> flights;
};

/// The flights' rows one after the other, a second or two gaps of their logs apart, each flight's
/// labels its own. Columns that are not in all of them are left out, with a note. Throws Error for
/// fewer than two, two of one name, or a flight without a time.
/// Each is read under the names of `choice`, as far as it has such columns, and in the units of the
/// first; read_as() then leaves the names as they are.
Flight join_flights(const std::vector<Flight>& flights, const LogChoice& choice,
                    std::vector<std::string>& notes);

/// Labels and sizes of flights: file names without their folder and ending where these differ, else
/// the whole names.
std::vector<JoinedFlight> describe_flights(const std::vector<Flight>& flights);

/// `one` on joined flights. Throws Error for a name in `own` that is not the probe's or that the
/// probe holds at a value, and where nothing is left to share.
std::shared_ptr<const Probe> joint_probe(std::shared_ptr<const Probe> one, JointSetup setup);

/// What a probe is joint of; nullptr of one that calibrates a single flight.
const JointSetup* joint_setup(const Probe& probe);

/// "wind" and such by the parameters they stand for: names of the probe's parameters, each once.
std::vector<std::string> resolve_own(const Probe& probe, const std::vector<std::string>& names);

/// Fits `probe` to all flights together and tests each for its departure from the others, unless a
/// loss or a model that depends on its own noise forbids that. Bounds, starts and priors of an own
/// parameter hold for each flight's. Throws Error as join_flights(), joint_probe() and calibrate().
Calibration calibrate_jointly(const std::shared_ptr<const Probe>& probe,
                              const std::vector<Flight>& flights,
                              const std::vector<std::string>& own,
                              const CalibrationOptions& options = {});

/// A joint calibration on one flight: of a flight that is among the fitted ones with what is its
/// own, of another one with not-a-numbers in its place. All its flights, joined, and what
/// is not joint get the calibration as it is.
Calibration for_flight(const Calibration& calibration, const Flight& flight);

/// Throws Error where for_flight() knows nothing of what is the flight's own.
void check_known(const Calibration& calibration, const Flight& flight);

/// The flights of a joint calibration, joined in its order. Throws Error where these are not they.
Flight rejoin_flights(const Calibration& calibration, const std::vector<Flight>& flights,
                      std::vector<std::string>& notes);

}  // namespace sepcal
