// SPDX-License-Identifier: BSD-3-Clause
// What a log is for a model of an aircraft, and several logs as one.
#include <fmt/format.h>

#include <algorithm>

#include "flight/aircraft/aircraft_columns.hpp"
#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/checks/checked_subject.hpp"
#include "flight/checks/log.hpp"
#include "sepcal/detail/flight/joint.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own

namespace {

/// Rates are differentiated, and gaps are seen, by the step of the whole.
void check_rates(const std::vector<Flight>& flights) {
  constexpr double alike = 1.5;
  std::vector<double> steps;
  for (const Flight& flight : flights) {
    steps.push_back(checks::Log(quantities_of(AircraftModel::path), flight).interval());
  }
  const auto [least, largest] = std::ranges::minmax_element(steps);
  if (steps.empty() || !(*largest > alike * *least)) return;
  throw Error(fmt::format(
      "{} has {:.3g} rows a second and {} has {:.3g}; flights that are fitted together need about "
      "the same rate: thin the faster log out, or fit them one by one",
      flights[static_cast<std::size_t>(least - steps.begin())].name(), 1.0 / *least,
      flights[static_cast<std::size_t>(largest - steps.begin())].name(), 1.0 / *largest));
}

}  // namespace

FlightCheck check_aircraft(AircraftModel model, const Flight& flight, const LogChoice& log,
                           const std::function<std::string(const std::string& name)>& spell) {
  const auto as_fitted = [&](const Flight& read, const LogChoice& choice) {
    ProbeRecord prepared = prepare(read, {model, is_symmetric(model, {})}, choice);
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
  check_rates(flights);
  return join_flights(flights, log, notes);
}

}  // namespace sepcal
