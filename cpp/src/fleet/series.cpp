// SPDX-License-Identifier: BSD-3-Clause
// A vehicle's parameters in time. With S_a..b the misfit left by one set of parameters for flights
// a to b, a change after k takes D_k = S_1..n - S_1..k - S_k+1..n, and flights scatter within by
// W_k = S_1..k + S_k+1..n - sum S_i..i: F = (D_k / p) / (W_k / (p (n - 2))).
#include <algorithm>
#include <cmath>

#include "fleet/common.hpp"
#include "fleet/vehicles.hpp"
#include "numerics/tails.hpp"
#include "sepcal/fleet.hpp"

namespace sepcal {

using fleet::parameter_rows;
using fleet::sum;
using fleet::tell;
using fleet::Told;

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr std::size_t fewest = 4;  // flights that show a change

double left(const TriangularFactor& factor) { return remaining_square(factor); }

/// What `before` and `after` differ by most of its errors.
void name_parameter(const Told& before, const Told& after, double inflation,
                    const std::vector<std::string>& parameters, VehicleSeries& series) {
  double largest = -1.0;
  for (Index k = 0; k < before.values.size(); ++k) {
    const double error = inflation * std::sqrt(before.covariance(k, k) + after.covariance(k, k));
    const double size = std::abs(after.values[k] - before.values[k]) / error;
    if (!(size > largest)) continue;
    largest = size;
    series.parameter = parameters[static_cast<std::size_t>(k)];
    series.before = before.values[k];
    series.after = after.values[k];
    series.standard_error = error;
  }
}

VehicleSeries follow_vehicle(const std::vector<FleetFlight>& flights,
                             const fleet::Vehicle& vehicle) {
  const FlightFactor& first = flights[vehicle.flights.front()].factor;
  const VectorXd& reference = first.values;
  const Index p = reference.size();
  const std::size_t n = vehicle.flights.size();
  VehicleSeries series{.vehicle = vehicle.name};
  series.values.resize(p, static_cast<Index>(n));
  series.errors.resize(p, static_cast<Index>(n));
  std::vector<TriangularFactor> own;
  std::vector<TriangularFactor> before{TriangularFactor(static_cast<int>(p) + 1)};
  double alone = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const FleetFlight& flight = flights[vehicle.flights[i]];
    series.flights.push_back(flight.name);
    own.push_back(parameter_rows(flight.factor, reference));
    before.push_back(sum(before.back(), own.back()));
    alone += left(own.back());
    const Told told = tell(own.back(), reference);
    series.values.col(static_cast<Index>(i)) = told.values;
    series.errors.col(static_cast<Index>(i)) = told.covariance.diagonal().cwiseSqrt();
    if (n == 1) series.errors.array() *= fleet::inflation_of(flight.factor).array().sqrt();
  }
  const double whole = left(before.back());
  const auto free = static_cast<double>(p);
  const auto count = static_cast<double>(n);
  if (n > 1) {
    series.inflation = std::sqrt(std::max(1.0, (whole - alone) / (free * (count - 1.0))));
  }
  if (n >= fewest) {
    double best = -1.0;
    TriangularFactor after(static_cast<int>(p) + 1);
    TriangularFactor best_after = after;
    for (std::size_t k = n - 1; k >= 1; --k) {
      after.merge(own[k]);
      const double parted = left(before[k]) + left(after);
      const double scatter = std::max(1.0, (parted - alone) / (free * (count - 2.0)));
      const double F = (whole - parted) / free / scatter;
      if (F <= best) continue;
      best = F;
      best_after = after;
      series.change = k;
      series.inflation = std::sqrt(scatter);
    }
    series.log10_p =
        std::min(0.0, numerics::log10_f_tail(std::max(0.0, best), free, free * (count - 2.0)) +
                          std::log10(count - 1.0));
    name_parameter(tell(before[series.change], reference), tell(best_after, reference),
                   series.inflation, first.parameters, series);
  }
  series.errors *= series.inflation;
  return series;
}

}  // namespace

std::vector<VehicleSeries> follow_vehicles(const std::vector<FleetFlight>& flights,
                                           const std::vector<std::string>& common) {
  const std::vector<fleet::Vehicle> vehicles = fleet::group_vehicles(flights);
  std::vector<FleetFlight> held;
  if (!common.empty()) {
    const fleet::Parting parting = fleet::part(flights, common);
    held = fleet::hold_common(flights, parting,
                              fleet::find_common(flights, vehicles, parting).told.values);
  }
  std::vector<VehicleSeries> all;
  for (const fleet::Vehicle& vehicle : vehicles) {
    all.push_back(follow_vehicle(common.empty() ? flights : held, vehicle));
  }
  for (VehicleSeries& series : all) {
    series.p_adjusted =
        std::min(1.0, std::pow(10.0, series.log10_p) * static_cast<double>(all.size()));
  }
  return all;
}

}  // namespace sepcal
