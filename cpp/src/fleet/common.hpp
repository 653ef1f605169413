// SPDX-License-Identifier: BSD-3-Clause
// Parameters that the whole fleet shares. With [R_11 R_12 q_1; 0 R_22 q_2] a vehicle's triangle,
// its own parameters first, the rows [R_22 q_2] of all vehicles tell the common ones, and these
// given each vehicle's own follow: a block arrow (Golub & Van Loan, Sec. 4.5).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fleet/vehicles.hpp"
#include "sepcal/fleet.hpp"

namespace sepcal::fleet {

/// Places among the p parameters.
struct Parting {
  std::vector<Eigen::Index> own = {};     // of the vehicle
  std::vector<Eigen::Index> common = {};  // of the fleet
};

/// Throws Error for a name that no parameter has, and where none is left to the vehicles.
Parting part(const std::vector<FleetFlight>& flights, const std::vector<std::string>& common);

/// The common parameters from all vehicles; NaN where these do not tell.
struct CommonFit {
  Told told;
  Eigen::MatrixXd jackknife;  // by leaving out a vehicle each; NaN for fewer than three
};

CommonFit find_common(const std::vector<FleetFlight>& flights, const std::vector<Vehicle>& vehicles,
                      const Parting& parting);

/// The flights with common parameters held at `values`, their parameters the vehicle's own.
std::vector<FleetFlight> hold_common(const std::vector<FleetFlight>& flights,
                                     const Parting& parting, const Eigen::VectorXd& values);

/// The flights with common parameters as columns before those of candidates, and the parameter's
/// name as the effect's.
std::vector<FleetFlight> common_as_columns(const std::vector<FleetFlight>& flights,
                                           const Parting& parting);

}  // namespace sepcal::fleet
