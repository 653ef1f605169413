// SPDX-License-Identifier: BSD-3-Clause
// The two stages as fit() runs them, on one checked problem and one pool of threads.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/thread_pool.hpp"
#include "estimation/problem.hpp"
#include "model/measurements.hpp"
#include "sepcal/stage_one.hpp"
#include "sepcal/triangular_factor.hpp"

namespace sepcal::estimation {

struct Attempt;

/// Steps 2-4.
StageOne run_stage_one(const Problem& problem, const Record& record, base::ThreadPool& pool);

/// Where stage two ended, over the free parameters (n of them).
struct StageTwo {
  Eigen::VectorXd x;                        // n: xi1, xi2
  Eigen::VectorXd noise;                    // n_z standard deviations
  std::vector<bool> at_bound;               // n
  std::vector<TriangularFactor> factors;    // n_z, [A | D | r] at x, not whitened
  SecondStage method = SecondStage::joint;  // joint or projected: what was used in the end
  int noise_iterations = 0;
  int iterations = 0;
  bool converged = false;
  bool held = false;  // a loose prior held what the record leaves open
  std::string message;
};

/// Sum of squared residuals by output, off factors of [A | D | r] (n_z).
Eigen::VectorXd squares(const std::vector<TriangularFactor>& factors);

/// J of Eq. 6 at `two`, without its constant, with what is known beforehand.
double find_cost(const Problem& problem, const StageTwo& two, double rows);

/// Step 5, from where stage one ended.
StageTwo run_stage_two(const Problem& problem, const model::Measurements& measurements,
                       const StageOne& start, base::ThreadPool& pool);

/// The same in the ways given (at least one), until one of them is enough.
StageTwo run_stage_two(const Problem& problem, const model::Measurements& measurements,
                       const StageOne& start, const std::vector<Attempt>& attempts,
                       base::ThreadPool& pool);

}  // namespace sepcal::estimation
