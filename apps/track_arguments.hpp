// SPDX-License-Identifier: BSD-3-Clause
// The options of track.
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "sepcal/flight/track.hpp"

namespace sepcal::app {

/// How a track is run.
class TrackArguments {
 public:
  /// Those of every subject; they fill this object, which must outlive the parsing.
  void add_to(CLI::App& verb);

  /// Those of an aircraft, which may be two steps.
  void add_to_aircraft(CLI::App& verb);

  /// Those of a sensor, which has no state.
  void add_to_sensor(CLI::App& verb);

  /// Throws Error for what doesn't mean anything.
  FlightTrackOptions resolve() const;

 private:
  std::string method_ = std::string(to_string(TrackMethod::ekf));
  std::string changes_ = std::string(to_string(TrackChanges::ignore));
  std::vector<std::string> walk_;
  std::vector<std::string> noise_;
  std::string own_;
  std::string band_;
  std::string second_ = std::string(to_string(TrackMethod::rls));
  FlightTrackOptions options_;
};

}  // namespace sepcal::app
