// SPDX-License-Identifier: BSD-3-Clause
#include "fleet/vehicles.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace fleet {

TriangularFactor parameter_rows(const FlightFactor& factor, const VectorXd& reference) {
  const auto p = static_cast<Index>(factor.parameters.size());
  const MatrixXd rows = rows_about(factor, reference);
  MatrixXd own(rows.rows(), p + 1);
  own << rows.leftCols(p), rows.rightCols<1>();
  TriangularFactor merged(static_cast<int>(p + 1));
  merged.absorb(own);
  return merged;
}

TriangularFactor sum(const TriangularFactor& a, const TriangularFactor& b) {
  TriangularFactor both = a;
  both.merge(b);
  return both;
}

std::vector<Vehicle> group_vehicles(const std::vector<FleetFlight>& flights) {
  if (flights.empty()) throw Error("a fleet has at least one flight");
  std::vector<Vehicle> vehicles;
  std::set<std::string> names;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const FleetFlight& flight = flights[i];
    if (!names.insert(flight.name).second) {
      throw Error("two flights are called '" + flight.name + "'");
    }
    if (flight.factor.parameters != flights.front().factor.parameters) {
      throw Error("flight '" + flight.name + "' has other parameters than '" +
                  flights.front().name + "'");
    }
    auto vehicle = std::ranges::find(vehicles, flight.vehicle, &Vehicle::name);
    if (vehicle == vehicles.end()) {
      vehicle = vehicles.insert(vehicles.end(), {.name = flight.vehicle});
    }
    vehicle->flights.push_back(i);
  }
  return vehicles;
}

MatrixXd rows_about(const FlightFactor& factor, const VectorXd& reference) {
  MatrixXd rows = factor.triangle;
  rows.rightCols<1>() += rows.leftCols(reference.size()) * (factor.values - reference);
  return rows;
}

TriangularFactor merge_parameters(const std::vector<FleetFlight>& flights, const Vehicle& vehicle,
                                  const VectorXd& reference) {
  TriangularFactor all(static_cast<int>(reference.size()) + 1);
  for (const std::size_t i : vehicle.flights) {
    all.merge(parameter_rows(flights[i].factor, reference));
  }
  return all;
}

Told tell(const TriangularFactor& rows, const VectorXd& reference) {
  const Index p = reference.size();
  const MatrixXd& T = rows.matrix();
  const MatrixXd R = T.topLeftCorner(p, p);
  const TriangularSolution solution = solve_triangular(R, T.col(p).head(p));
  const MatrixXd inverse = generalised_inverse(R);
  Told told{.values = reference + solution.x, .covariance = inverse * inverse.transpose()};
  if (solution.rank == p) return told;
  // A parameter is told where the triangle gives it back, whatever is added along what it does not
  // see.
  const MatrixXd back = inverse * R;
  for (Index k = 0; k < p; ++k) {
    if ((back.row(k).transpose() - VectorXd::Unit(p, k)).norm() < 1e-6) continue;
    told.values[k] = not_a_number;
    told.covariance.row(k).setConstant(not_a_number);
    told.covariance.col(k).setConstant(not_a_number);
  }
  return told;
}

MatrixXd jackknife(const std::vector<FleetFlight>& flights, const Vehicle& vehicle,
                   const VectorXd& reference) {
  const Index p = reference.size();
  const std::size_t n = vehicle.flights.size();
  MatrixXd undefined = MatrixXd::Constant(p, p, not_a_number);
  if (n < 3) return undefined;
  std::vector<TriangularFactor> before{TriangularFactor(static_cast<int>(p) + 1)};
  std::vector<TriangularFactor> own;
  for (const std::size_t i : vehicle.flights) {
    own.push_back(parameter_rows(flights[i].factor, reference));
    before.push_back(sum(before.back(), own.back()));
  }
  TriangularFactor after(static_cast<int>(p) + 1);
  MatrixXd estimates(p, static_cast<Index>(n));
  for (std::size_t i = n; i-- > 0;) {
    const TriangularFactor others = sum(before[i], after);
    const MatrixXd& T = others.matrix();
    const TriangularSolution solution = solve_triangular(T.topLeftCorner(p, p), T.col(p).head(p));
    if (solution.rank < p) return undefined;
    estimates.col(static_cast<Index>(i)) = solution.x;
    after.merge(own[i]);
  }
  const MatrixXd off = estimates.colwise() - estimates.rowwise().mean();
  const auto count = static_cast<double>(n);
  return (count - 1.0) / count * off * off.transpose();
}

}  // namespace fleet

std::vector<VehicleFit> fit_vehicles(const std::vector<FleetFlight>& flights) {
  std::vector<VehicleFit> fits;
  for (const fleet::Vehicle& vehicle : fleet::group_vehicles(flights)) {
    const VectorXd reference = flights[vehicle.flights.front()].factor.values;
    const TriangularFactor rows = fleet::merge_parameters(flights, vehicle, reference);
    fleet::Told told = fleet::tell(rows, reference);
    VehicleFit fit{.vehicle = vehicle.name,
                   .flights = vehicle.flights.size(),
                   .values = std::move(told.values),
                   .covariance = std::move(told.covariance),
                   .jackknife = fleet::jackknife(flights, vehicle, reference),
                   .misfit = remaining_square(rows)};
    for (const std::size_t i : vehicle.flights) fit.readings += flights[i].factor.readings;
    fits.push_back(std::move(fit));
  }
  return fits;
}

}  // namespace sepcal
