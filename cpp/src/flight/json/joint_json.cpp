// SPDX-License-Identifier: BSD-3-Clause
#include "flight/json/joint_json.hpp"

#include "sepcal/detail/flight/joint.hpp"

namespace sepcal::json {

Json write_joint(const Calibration& calibration) {
  const JointSetup& setup = *joint_setup(*calibration.probe);
  Json flights = Json::array();
  for (const JoinedFlight& flight : setup.flights) {
    flights.push_back({{"label", flight.label},
                       {"file", flight.file},
                       {"sha256", flight.sha256},
                       {"rows", flight.rows}});
  }
  Json departures = Json::array();
  for (const FlightDeparture& departure : calibration.departures) {
    departures.push_back({{"flight", departure.flight},
                          {"p", number(departure.p)},
                          {"parameter", departure.parameter},
                          {"difference", number(departure.difference)},
                          {"standard_error", number(departure.standard_error)}});
  }
  return {
      {"own", setup.own}, {"flights", std::move(flights)}, {"departures", std::move(departures)}};
}

void read_joint(const Json& object, Calibration& calibration) {
  JointSetup setup;
  setup.own = object.at("own").get<std::vector<std::string>>();
  for (const Json& flight : elements_of(object.at("flights"))) {
    setup.flights.push_back({.label = flight.at("label").get<std::string>(),
                             .file = flight.at("file").get<std::string>(),
                             .sha256 = files::sha256_of(flight.at("sha256")),
                             .rows = flight.at("rows").get<std::size_t>()});
  }
  calibration.probe = joint_probe(calibration.probe, std::move(setup));
  for (const Json& departure : elements_of(object.at("departures"))) {
    calibration.departures.push_back(
        {.flight = departure.at("flight").get<std::string>(),
         .p = number_or(departure.at("p"), not_a_number),
         .parameter = departure.at("parameter").get<std::string>(),
         .difference = number_or(departure.at("difference"), not_a_number),
         .standard_error = number_or(departure.at("standard_error"), not_a_number)});
  }
}

}  // namespace sepcal::json
