// SPDX-License-Identifier: BSD-3-Clause
// What each flight and vehicle says of candidates' columns, once the vehicle's own parameters are
// projected out: information I_f = G'G and score s_f = G'r, with sums over a vehicle's flights.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "fleet/vehicles.hpp"
#include "sepcal/fleet.hpp"

namespace sepcal::fleet {

/// Columns that are asked for together: an effect's, or a parameter's growth with an attribute.
struct Group {
  FleetCause cause = FleetCause::everywhere;  // or grows
  std::string effect = {};
  std::vector<Eigen::Index> columns = {};
  bool stands_in = false;
};

/// A vehicle's estimate of a group's coefficients, and how its flights scatter about it.
struct VehicleScore {
  bool tells = false;                // whether its flights see all of them
  Eigen::MatrixXd information = {};  // q x q
  Eigen::VectorXd estimate = {};     // q
  double inflation = 0.0;            // of the variance, by leaving out flights; 0 where freedom is
  double freedom = 0.0;              // of that
};

class Scores {
 public:
  /// `flights` must outlive it. Throws Error as group_vehicles() does.
  explicit Scores(const std::vector<FleetFlight>& flights);

  const std::vector<Group>& groups() const { return groups_; }
  const std::vector<CandidateColumn>& columns() const { return columns_; }
  std::size_t vehicles() const { return vehicles_.size(); }
  const std::string& vehicle(std::size_t v) const { return vehicles_[v].of.name; }
  std::size_t flights(std::size_t v) const { return vehicles_[v].flights.size(); }

  /// Columns are kept in units in which each has unit length over the fleet: what a coefficient is
  /// in those of its effect.
  double unit_of(Eigen::Index column) const { return 1.0 / norms_[column]; }

  /// Gives a vehicle these coefficients of its own.
  void free(std::size_t vehicle, const std::vector<Eigen::Index>& columns);
  bool is_free(std::size_t vehicle, Eigen::Index column) const;

  /// Of these columns: sum over the vehicle's flights.
  Eigen::MatrixXd information(std::size_t vehicle, const std::vector<Eigen::Index>& columns) const;
  Eigen::VectorXd score(std::size_t vehicle, const std::vector<Eigen::Index>& columns) const;

  /// Information and score of each flight by itself, where flights and not vehicles are compared.
  void each_flight(std::size_t vehicle, const std::vector<Eigen::Index>& columns,
                   std::vector<Eigen::MatrixXd>& informations,
                   std::vector<Eigen::VectorXd>& scores) const;

  /// Beside `known` coefficients (in units of length) of the `accepted` columns.
  VehicleScore of_vehicle(std::size_t vehicle, const std::vector<Eigen::Index>& columns,
                          const std::vector<Eigen::Index>& accepted,
                          const Eigen::VectorXd& known) const;

  /// Each flight's misfit, in the order of the flights, with these coefficients.
  std::vector<double> misfits(const std::vector<Eigen::Index>& accepted,
                              const Eigen::VectorXd& known) const;

 private:
  struct Part {            // of a flight
    Eigen::MatrixXd rows;  // [parameters | columns | residual], as it came
    Eigen::MatrixXd Q;     // orthonormal over the vehicle's flights: what the vehicle estimates
    Eigen::MatrixXd G;     // columns beyond that
    Eigen::VectorXd r;     // residual beyond that
  };
  struct Growth {  // of a parameter with an attribute
    Eigen::Index column;
    Eigen::Index parameter;
    std::string attribute;
  };
  struct Rows {
    Vehicle of;
    std::vector<Eigen::Index> own = {};  // columns that are the vehicle's own
    std::vector<Part> flights = {};
    Eigen::MatrixXd information = {};  // columns x columns
    Eigen::VectorXd score = {};
  };

  void find_groups(const std::vector<FleetFlight>& flights);
  void project(Rows& vehicle) const;

  std::vector<CandidateColumn> columns_ = {};
  std::vector<Group> groups_ = {};
  std::vector<Growth> growths_ = {};
  Eigen::Index parameters_ = 0;
  Eigen::VectorXd norms_ = {};  // of columns
  std::size_t count_ = 0;       // of flights
  std::vector<Rows> vehicles_ = {};
};

}  // namespace sepcal::fleet
