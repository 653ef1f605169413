// SPDX-License-Identifier: BSD-3-Clause
#include "calibrated_flights.hpp"

namespace sepcal::test {

Flight make_flight(const SimulatedFlight& simulated) {
  Flight flight("flight");
  for (const SimulatedColumn& column : simulated.columns) flight.add(column.name, column.values);
  return flight.label(simulated.maneuver);
}

std::shared_ptr<const Probe> make_five_hole() {
  return five_hole_probe(4.5, 4.5, {0.35, 0.0, -0.02});
}

Eigen::VectorXd order_values(const Probe& probe, const std::map<std::string, double>& by_name) {
  const auto parameters = probe.model().tables().parameters();
  Eigen::VectorXd values(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    values[static_cast<Eigen::Index>(k)] = by_name.at(parameters[k].name);
  }
  return values;
}

Calibration make_calibration(const std::shared_ptr<const Probe>& probe,
                             const std::map<std::string, double>& by_name) {
  Calibration calibration;
  calibration.probe = probe;
  calibration.fit.status = FitStatus::converged;
  calibration.fit.n_1 = probe->model().tables().n_1();
  for (const Variable& variable : probe->model().tables().parameters()) {
    calibration.fit.parameters.push_back(
        {.name = variable.name, .unit = variable.unit, .value = by_name.at(variable.name)});
  }
  return calibration;
}

}  // namespace sepcal::test
