// SPDX-License-Identifier: BSD-3-Clause
#include "fleet/vehicles.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "fleet/common.hpp"
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
    const Index inflations = flight.factor.inflation.size();
    if (inflations != 0 && inflations != flight.factor.values.size()) {
      throw Error("flight '" + flight.name + "': give an inflation for each of its parameters");
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

VectorXd inflation_of(const FlightFactor& factor) {
  return factor.inflation.size() > 0 ? factor.inflation : VectorXd::Ones(factor.values.size());
}

VectorXd mean_inflation(const std::vector<FleetFlight>& flights,
                        const std::vector<std::size_t>& places) {
  VectorXd sum = VectorXd::Zero(flights.front().factor.values.size());
  for (const std::size_t i : places) sum += inflation_of(flights[i].factor);
  return sum / static_cast<double>(places.size());
}

std::string rate_name(const std::string& parameter, const std::string& attribute) {
  return parameter + "[" + attribute + "]";
}

std::string rate_unit(const std::string& unit, const std::string& attribute) {
  return (unit.empty() ? "1" : unit) + "/" + attribute;
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

MatrixXd jackknife(const std::vector<TriangularFactor>& parts) {
  const Index p = parts.front().columns() - 1;
  const std::size_t n = parts.size();
  MatrixXd undefined = MatrixXd::Constant(p, p, not_a_number);
  if (n < 3) return undefined;
  std::vector<TriangularFactor> before{TriangularFactor(parts.front().columns())};
  for (const TriangularFactor& one : parts) before.push_back(sum(before.back(), one));
  TriangularFactor after(parts.front().columns());
  MatrixXd estimates(p, static_cast<Index>(n));
  for (std::size_t i = n; i-- > 0;) {
    const TriangularFactor others = sum(before[i], after);
    const MatrixXd& T = others.matrix();
    const TriangularSolution solution = solve_triangular(T.topLeftCorner(p, p), T.col(p).head(p));
    if (solution.rank < p) return undefined;
    estimates.col(static_cast<Index>(i)) = solution.x;
    after.merge(parts[i]);
  }
  const MatrixXd off = estimates.colwise() - estimates.rowwise().mean();
  const auto count = static_cast<double>(n);
  return (count - 1.0) / count * off * off.transpose();
}

}  // namespace fleet

namespace {

/// From the vehicle's flights alone.
VehicleFit fit_vehicle(const std::vector<FleetFlight>& flights, const fleet::Vehicle& vehicle) {
  const VectorXd& reference = flights[vehicle.flights.front()].factor.values;
  std::vector<TriangularFactor> own;
  VehicleFit fit{.vehicle = vehicle.name,
                 .flights = vehicle.flights.size(),
                 .inflation = fleet::mean_inflation(flights, vehicle.flights)};
  TriangularFactor all(static_cast<int>(reference.size()) + 1);
  for (const std::size_t i : vehicle.flights) {
    own.push_back(fleet::parameter_rows(flights[i].factor, reference));
    all.merge(own.back());
    fit.readings += flights[i].factor.readings;
  }
  fleet::Told told = fleet::tell(all, reference);
  fit.values = std::move(told.values);
  const auto errors = fit.inflation.cwiseSqrt().asDiagonal();
  fit.covariance = errors * told.covariance * errors;
  fit.jackknife = fleet::jackknife(own);
  fit.misfit = remaining_square(all);
  return fit;
}

/// What a vehicle's own parameters move by as the common ones do, -R_11^-1 R_12 (own x common).
MatrixXd slope_of(const MatrixXd& T, const fleet::Parting& parting) {
  std::vector<Index> order = parting.own;
  order.insert(order.end(), parting.common.begin(), parting.common.end());
  MatrixXd rows = T(Eigen::all, order);
  TriangularFactor factor(static_cast<int>(rows.cols()));
  factor.absorb(rows);
  const auto own = std::ssize(parting.own);
  const auto common = std::ssize(parting.common);
  return -generalised_inverse(factor.matrix().topLeftCorner(own, own)) *
         factor.matrix().topRows(own).rightCols(common);
}

/// An error of own parameters, with what that of common ones adds.
MatrixXd with_common(const MatrixXd& own, const MatrixXd& common, const MatrixXd& slope,
                     const fleet::Parting& parting) {
  MatrixXd all(own.rows() + common.rows(), own.rows() + common.rows());
  all(parting.own, parting.own) = own + slope * common * slope.transpose();
  all(parting.own, parting.common) = slope * common;
  all(parting.common, parting.own) = common * slope.transpose();
  all(parting.common, parting.common) = common;
  return all;
}

}  // namespace

FlightFactor with_rate(const FlightFactor& factor, const std::string& parameter,
                       const std::string& attribute, double distance) {
  const auto at = std::ranges::find(factor.parameters, parameter);
  if (at == factor.parameters.end()) {
    throw Error("the fleet has no parameter '" + parameter + "'");
  }
  const Index k = at - factor.parameters.begin();
  const Index p = std::ssize(factor.parameters);
  const MatrixXd& T = factor.triangle;
  MatrixXd rows(T.rows(), T.cols() + 1);
  rows << T.leftCols(p), T.col(k) * distance, T.rightCols(T.cols() - p);
  TriangularFactor triangle(static_cast<int>(rows.cols()));
  triangle.absorb(rows);
  FlightFactor grown = factor;
  grown.parameters.push_back(fleet::rate_name(parameter, attribute));
  grown.units.push_back(fleet::rate_unit(factor.units[static_cast<std::size_t>(k)], attribute));
  grown.values.conservativeResize(p + 1);
  grown.values[p] = 0.0;
  const VectorXd inflation = fleet::inflation_of(factor);
  grown.inflation.resize(p + 1);
  grown.inflation << inflation, inflation[k];
  grown.triangle = triangle.matrix();
  return grown;
}

std::vector<VehicleFit> fit_vehicles(const std::vector<FleetFlight>& flights,
                                     const std::vector<std::string>& common) {
  const std::vector<fleet::Vehicle> vehicles = fleet::group_vehicles(flights);
  std::vector<VehicleFit> fits;
  if (common.empty()) {
    for (const fleet::Vehicle& vehicle : vehicles) fits.push_back(fit_vehicle(flights, vehicle));
    return fits;
  }
  const fleet::Parting parting = fleet::part(flights, common);
  const auto [told, jackknife] = fleet::find_common(flights, vehicles, parting);
  if (!told.values.allFinite()) throw Error("no flight tells what is common to all");
  std::vector<std::size_t> every(flights.size());
  std::iota(every.begin(), every.end(), std::size_t{0});
  const VectorXd inflation = fleet::mean_inflation(flights, every);
  const auto errors = inflation(parting.common).cwiseSqrt().eval().asDiagonal();
  const MatrixXd covariance = errors * told.covariance * errors;
  const std::vector<FleetFlight> held = fleet::hold_common(flights, parting, told.values);
  for (const fleet::Vehicle& vehicle : vehicles) {
    VehicleFit fit = fit_vehicle(held, vehicle);
    const VectorXd& reference = flights.front().factor.values;
    const TriangularFactor all = fleet::merge_parameters(flights, vehicle, reference);
    const MatrixXd slope = slope_of(all.matrix().leftCols(reference.size()), parting);
    VectorXd values(reference.size());
    values(parting.own) = fit.values;
    values(parting.common) = told.values;
    fit.values = std::move(values);
    fit.covariance = with_common(fit.covariance, covariance, slope, parting);
    const VectorXd own = fit.inflation;
    fit.inflation = inflation;
    fit.inflation(parting.own) = own;
    fit.jackknife = with_common(fit.jackknife, jackknife, slope, parting);
    fits.push_back(std::move(fit));
  }
  return fits;
}

}  // namespace sepcal
