// SPDX-License-Identifier: BSD-3-Clause
// The flights of each vehicle, about one point.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/fleet.hpp"

namespace sepcal::fleet {

struct Vehicle {
  std::string name;
  std::vector<std::size_t> flights = {};  // places among the fleet's
};

/// In the order in which they come. Throws Error for no flight, for two of one name, and for a
/// flight whose parameters are not those of the first.
std::vector<Vehicle> group_vehicles(const std::vector<FleetFlight>& flights);

/// The rows [parameters | columns | residual] of a flight, the residual as it would be at
/// `reference`.
Eigen::MatrixXd rows_about(const FlightFactor& factor, const Eigen::VectorXd& reference);

/// [parameters | residual] of a flight, at `reference`.
TriangularFactor parameter_rows(const FlightFactor& factor, const Eigen::VectorXd& reference);

TriangularFactor sum(const TriangularFactor& a, const TriangularFactor& b);

/// [parameters | residual] of all the vehicle's flights, at `reference`.
TriangularFactor merge_parameters(const std::vector<FleetFlight>& flights, const Vehicle& vehicle,
                                  const Eigen::VectorXd& reference);

/// Of variances (p): 1 where none is given.
Eigen::VectorXd inflation_of(const FlightFactor& factor);

/// Over these flights (p).
Eigen::VectorXd mean_inflation(const std::vector<FleetFlight>& flights,
                               const std::vector<std::size_t>& places);

/// Of a parameter that grows with an attribute: "s_va[age_days]", "1/age_days".
std::string rate_name(const std::string& parameter, const std::string& attribute);
std::string rate_unit(const std::string& unit, const std::string& attribute);

/// Parameters and their covariance; NaN for what the rows do not tell.
struct Told {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

/// What rows [parameters | residual] at `reference` say.
Told tell(const TriangularFactor& rows, const Eigen::VectorXd& reference);

/// By leaving out each of some rows [parameters | residual], of flights say: (n - 1)/n sum of
/// squares of the estimates about their mean; NaN for fewer than three, and where what is left does
/// not tell.
Eigen::MatrixXd jackknife(const std::vector<TriangularFactor>& parts);

}  // namespace sepcal::fleet
