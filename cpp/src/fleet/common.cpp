// SPDX-License-Identifier: BSD-3-Clause
#include "fleet/common.hpp"

#include <algorithm>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal::fleet {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// The triangle of rows.
MatrixXd triangularise(MatrixXd rows) {
  TriangularFactor factor(static_cast<int>(rows.cols()));
  factor.absorb(rows);
  return factor.matrix();
}

/// The factor without its common parameters; of its rows [own | common | columns | residual].
FlightFactor of_own(const FlightFactor& factor, const Parting& parting) {
  FlightFactor own = factor;
  own.parameters.clear();
  own.units.clear();
  own.values = factor.values(parting.own);
  own.inflation = inflation_of(factor)(parting.own);
  for (const Index k : parting.own) {
    own.parameters.push_back(factor.parameters[static_cast<std::size_t>(k)]);
    own.units.push_back(factor.units[static_cast<std::size_t>(k)]);
  }
  return own;
}

}  // namespace

Parting part(const std::vector<FleetFlight>& flights, const std::vector<std::string>& common) {
  Parting parting;
  const std::vector<std::string>& all = flights.front().factor.parameters;
  for (const std::string& name : common) {
    if (std::ranges::find(all, name) != all.end()) continue;
    std::string there;
    for (const std::string& one : all) there += (there.empty() ? "" : ", ") + one;
    throw Error("common: the fleet has no parameter '" + name + "'; it has: " + there);
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool is_common = std::ranges::find(common, all[k]) != common.end();
    (is_common ? parting.common : parting.own).push_back(static_cast<Index>(k));
  }
  if (parting.own.empty()) {
    throw Error("common: leave a parameter to the vehicles; all of theirs are named");
  }
  return parting;
}

CommonFit find_common(const std::vector<FleetFlight>& flights, const std::vector<Vehicle>& vehicles,
                      const Parting& parting) {
  const VectorXd& reference = flights.front().factor.values;
  const Index p = reference.size();
  const auto own = std::ssize(parting.own);
  std::vector<Index> order = parting.own;
  order.insert(order.end(), parting.common.begin(), parting.common.end());
  order.push_back(p);
  std::vector<TriangularFactor> told;  // [common | residual] of each vehicle
  for (const Vehicle& vehicle : vehicles) {
    const MatrixXd T = merge_parameters(flights, vehicle, reference).matrix();
    MatrixXd below =
        triangularise(T(Eigen::all, order)).bottomRightCorner(p + 1 - own, p + 1 - own);
    told.emplace_back(static_cast<int>(below.cols())).absorb(below);
  }
  TriangularFactor all(static_cast<int>(p + 1 - own));
  for (const TriangularFactor& one : told) all.merge(one);
  return {tell(all, reference(parting.common)), jackknife(told)};
}

std::vector<FleetFlight> hold_common(const std::vector<FleetFlight>& flights,
                                     const Parting& parting, const VectorXd& values) {
  std::vector<FleetFlight> held;
  for (const FleetFlight& flight : flights) {
    VectorXd reference = flight.factor.values;
    reference(parting.common) = values;
    const MatrixXd rows = rows_about(flight.factor, reference);
    std::vector<Index> kept = parting.own;
    for (Index k = reference.size(); k < rows.cols(); ++k) kept.push_back(k);
    held.push_back(
        {flight.name, flight.vehicle, of_own(flight.factor, parting), flight.attributes});
    held.back().factor.triangle = triangularise(rows(Eigen::all, kept));
  }
  return held;
}

std::vector<FleetFlight> common_as_columns(const std::vector<FleetFlight>& flights,
                                           const Parting& parting) {
  std::vector<FleetFlight> changed;
  for (const FleetFlight& flight : flights) {
    const FlightFactor& factor = flight.factor;
    VectorXd reference = factor.values;
    reference(parting.common).setZero();
    const MatrixXd rows = rows_about(factor, reference);
    std::vector<Index> order = parting.own;
    order.insert(order.end(), parting.common.begin(), parting.common.end());
    for (Index k = reference.size(); k < rows.cols(); ++k) order.push_back(k);
    FlightFactor own = of_own(factor, parting);
    std::vector<CandidateColumn> columns;
    for (const Index k : parting.common) {
      const std::string& name = factor.parameters[static_cast<std::size_t>(k)];
      columns.push_back({name, name, factor.units[static_cast<std::size_t>(k)]});
    }
    own.columns.insert(own.columns.begin(), columns.begin(), columns.end());
    own.triangle = triangularise(rows(Eigen::all, order));
    changed.push_back({flight.name, flight.vehicle, std::move(own), flight.attributes});
  }
  return changed;
}

}  // namespace sepcal::fleet
