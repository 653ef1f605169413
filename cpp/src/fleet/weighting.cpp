// SPDX-License-Identifier: BSD-3-Clause
#include "fleet/weighting.hpp"

#include <fmt/format.h>

#include <cmath>

#include "fleet/vehicles.hpp"
#include "numerics/tails.hpp"

namespace sepcal::fleet {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The flights with these triangles in place of their own, of as many parameters as they have.
std::vector<FleetFlight> with_rows(const std::vector<FleetFlight>& flights, Index p,
                                   bool whitened) {
  std::vector<FleetFlight> changed;
  for (const FleetFlight& flight : flights) {
    FleetFlight one{.name = flight.name, .vehicle = flight.vehicle, .factor = {}};
    const MatrixXd& T = flight.factor.triangle;
    one.factor.values = flight.factor.values.head(p);
    one.factor.inflation = VectorXd::Ones(p);
    one.factor.triangle.resize(whitened ? p + 1 : T.rows(), p + 1);
    if (whitened) {
      one.factor.triangle = flight.factor.whitened;
    } else {
      one.factor.triangle << T.leftCols(p), T.rightCols<1>();
    }
    one.factor.parameters.assign(flight.factor.parameters.begin(),
                                 flight.factor.parameters.begin() + p);
    changed.push_back(std::move(one));
  }
  return changed;
}

}  // namespace

std::string note_weighting(const std::vector<FleetFlight>& flights, double significance) {
  const Index p = flights.front().factor.whitened.cols() - 1;  // rates have no rows of their own
  for (const FleetFlight& flight : flights) {
    if (flight.factor.whitened.cols() != p + 1 || p < 1) return "";
  }
  const std::vector<VehicleFit> alike = fit_vehicles(with_rows(flights, p, false));
  const std::vector<VehicleFit> fast = fit_vehicles(with_rows(flights, p, true));
  double least = std::log10(significance / static_cast<double>(p));
  std::string note;
  for (Index k = 0; k < p; ++k) {
    std::vector<double> differences;
    double mean = 0.0;
    double value = 0.0;
    for (std::size_t v = 0; v < alike.size(); ++v) {
      const double difference = fast[v].values[k] - alike[v].values[k];
      if (!std::isfinite(difference)) continue;
      differences.push_back(difference);
      mean += difference;
      value += alike[v].values[k];
    }
    if (differences.size() < 3) continue;
    const auto count = static_cast<double>(differences.size());
    mean /= count;
    value /= count;
    double square = 0.0;
    for (const double one : differences) square += (one - mean) * (one - mean);
    if (!(square > 0.0)) continue;  // white noise in all: no row is weighed otherwise
    const double F = mean * mean * count * (count - 1.0) / square;
    const double log10_p = numerics::log10_f_tail(F, 1.0, count - 1.0);
    if (log10_p >= least) continue;
    least = log10_p;
    note = fmt::format(
        "{0} is {1:.4g} on average where all rows weigh alike, and {2:.4g} where fast changes "
        "weigh "
        "more (p {3:.1g}): noise in an input, as gusts in the velocities are, pulls parameters "
        "like "
        "that. An effect that takes little of the error may only stand in for it.",
        flights.front().factor.parameters[static_cast<std::size_t>(k)], value, value + mean,
        std::min(1.0, std::pow(10.0, log10_p) * static_cast<double>(p)));
  }
  return note;
}

}  // namespace sepcal::fleet
