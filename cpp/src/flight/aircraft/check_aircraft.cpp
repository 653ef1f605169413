// SPDX-License-Identifier: BSD-3-Clause
// What a log is for a model of an aircraft, and several logs as one.
#include <algorithm>

#include "flight/aircraft/aircraft_columns.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/checks/checked_subject.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own

FlightCheck check_aircraft(AircraftModel model, const Flight& flight, const LogChoice& log,
                           const std::function<std::string(const std::string& name)>& spell) {
  const auto as_fitted = [&](const Flight& read, const LogChoice& choice) {
    ProbeRecord prepared = prepare(read, model, choice);
    within(read, [&] {
      if (model == AircraftModel::aero) {
        check_body_axes(prepared.record);
      } else {
        check_flight_path(prepared.record);
      }
    });
    return prepared;
  };
  return checks::check_subject({.model = std::string(to_string(model)),
                                .app = "sepcal-aircraft",
                                .quantities = quantities_of(model),
                                .asks_for_turns = model == AircraftModel::path,
                                .prepare = as_fitted},
                               flight, log, spell);
}

Flight join_aircraft_flights(std::vector<Flight> flights, const LogChoice& log,
                             std::vector<std::string>& notes, const AircraftFit* fitted) {
  if (fitted != nullptr) {
    std::ranges::stable_sort(
        flights, {}, [&](const Flight& flight) { return fitted->flight.file.find(flight.name()); });
  }
  return join_flights(flights, log, notes);
}

}  // namespace sepcal
