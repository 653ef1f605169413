// SPDX-License-Identifier: BSD-3-Clause
// Covariances of a joint fit, and what its departures are judged by. In the coordinates of one
// flight's K = [own cross; 0 joint] all flights together carry the information I, so that a score's
// covariance there is what the sandwich needs, flight by flight.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "many/arrowhead.hpp"
#include "many/joint_stage.hpp"

namespace sepcal::many {

/// A flight at the solution, without the parameters that a bound holds.
struct JudgedFlight {
  std::vector<Eigen::Index> columns;  // which of [own | shared] are left
  Share share;
  Eigen::MatrixXd
      middle;  // the score's covariance in K's coordinates; empty: as white noise has it
};

struct JointCovariance {
  std::vector<JudgedFlight> flights;
  std::vector<Eigen::Index> shared;  // which of the shared parameters are left, k of them
  Eigen::MatrixXd joint;             // k x k, upper: their factor, all flights' own projected out
  bool singular = false;             // then every covariance is NaN
  double ratio = 1.0;                // of the noise judged behind all of this to R, squared:
                                     // M / (M - n) where R was estimated; NaN: nothing is defined
  Eigen::MatrixXd middle_sum;        // of shared_middle() over all flights, and the prior

  bool is_defined() const { return !singular && !std::isnan(ratio); }

  /// White and as the flights' middles have it: of the shared parameters (k x k) and of a flight's
  /// own that are left.
  Eigen::MatrixXd shared_white() const;
  Eigen::MatrixXd shared_coloured() const;
  Eigen::MatrixXd own_white(Eigen::Index flight) const;
  Eigen::MatrixXd own_coloured(Eigen::Index flight) const;

  /// A flight's middle among the shared parameters (k x k).
  Eigen::MatrixXd shared_middle(Eigen::Index flight) const;

  /// What a flight contributes to the information I of the shared parameters: share.shared's R
  /// times joint^-1 (k x k).
  Eigen::MatrixXd contribution(Eigen::Index flight) const;

  /// Makes middle_sum of the flights' middles; the weights are those of the shared parameters'
  /// prior (layout.shared).
  void add_middles(const Eigen::VectorXd& prior_weights);
};

/// Without middles and of ratio 1. `blocks`: a flight's whitened factor of [own | shared | r] each;
/// `at_bound`: over the layout; `shared_prior`: rows of [shared | r].
JointCovariance factorise(const std::vector<TriangularFactor>& blocks,
                          const std::vector<bool>& at_bound, const Layout& layout,
                          const Eigen::MatrixXd& shared_prior);

/// The objective stands at the solution, where no loose prior holds it. With
/// FitOptions::coloured_errors the source is asked once more.
JointCovariance find_joint_covariance(const JointProblem& joint, const JointStage& stage,
                                      const ManyObjective& objective, FlightSource& source);

}  // namespace sepcal::many
