// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "flight/aircraft/laid_aircraft.hpp"
#include "flight/verbs/at_bound.hpp"
#include "sepcal/flight/aircraft.hpp"

namespace sepcal {

using namespace aircraft_log;  // this room's own

FlightIntervals find_aircraft_intervals(const AircraftFit& fitted, const Flight& flight,
                                        const ProfileOptions& asked) {
  if (!is_same_flight(fitted, flight)) {
    throw Error(
        fmt::format("{} is not the flight of the fit, {}: profiles are of the rows that "
                    "were fitted; give all of those, or fit this one",
                    flight.name(), fitted.flight.file));
  }
  if (fitted.fit.method == FitMethod::filter_error) {
    throw Error(
        "a fit by filter error is not profiled: its noises would have to be found anew at every "
        "point; its standard errors are of the likelihood");
  }
  need_rows_in_time(fitted, "is not profiled: it is linear, and its standard errors say all");
  const LaidAircraft laid = lay(flight, options_on(fitted, flight));
  return {
      .model = std::string(to_string(fitted.options.model)),
      .flight = fitted.flight,
      .status = fitted.fit.status,
      .message = fitted.fit.message,
      .at_bound = verbs::names_at_bound(fitted.fit),
      .level = asked.level,
      .parameters = within(
          flight,
          [&] { return profile_intervals(*laid.model, laid.record, fitted.fit, laid.fit, asked); }),
      .notes = laid.notes};
}

}  // namespace sepcal
