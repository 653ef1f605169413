// SPDX-License-Identifier: BSD-3-Clause
// Stage two of many flights: descent, last digits and R in turn, as stage_two.cpp does for one.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/problem.hpp"
#include "many/arrowhead.hpp"
#include "many/many_objective.hpp"

namespace sepcal::many {

/// What a test of departure has to know of the flights beside their covariance.
struct Compared {
  Layout layout;
  std::vector<double> measurements;  // of each flight
  bool chi_squared = false;          // R is known, or among the parameters
};

/// The joint fit's question, complete.
struct JointProblem {
  const estimation::Problem& problem;
  const Split& parting;
  Layout layout;
  numerics::Box box;                    // of all flights' parameters
  std::vector<FlightStart> starts;      // of the flights that take part
  double rows = 0.0;                    // of all flights
  Eigen::VectorXd output_squares = {};  // n_z, over all flights

  bool noise_given() const { return problem.noise().size() > 0; }

  Compared compared() const;

  /// Over [own | shared]; none or one.
  std::vector<estimation::Prior> prior() const;

  /// Below it the noise of output j is rounding.
  double noise_floor(Eigen::Index j) const;
};

struct JointStage {
  Eigen::VectorXd x;
  Eigen::VectorXd noise;
  std::vector<bool> at_bound;
  bool refined = false;  // x is a minimum at this noise, to the last digit
  bool settled = false;  // the noise is that of x (Eq. 26), or was given
  int iterations = 0;
  int noise_iterations = 0;
  std::vector<std::string> sentences;  // what a reader has to know

  bool converged() const { return refined && settled; }
};

/// At the objective's point: each flight without its own parameters, and all flights together with
/// the prior of the shared ones (n_shared x n_shared, upper).
struct Eliminated {
  std::vector<Share> shares;
  Eigen::MatrixXd shared;
};
Eliminated eliminate_own(const ManyObjective& objective);

/// Plausible lengths of all flights' parameters, off the factors at the objective's point.
Eigen::VectorXd plausible_lengths(const JointProblem& joint, const ManyObjective& objective);

/// From the flights' own fits; the objective ends linearised at the solution, and no loose
/// prior holds it.
JointStage run_joint_stage(const JointProblem& joint, ManyObjective& objective);

}  // namespace sepcal::many
