// SPDX-License-Identifier: BSD-3-Clause
// Stage two: the constrained maximum-likelihood fit (Sun & Gebre-Egziabher, Step 5, Eqs. 6, 20,
// 24-27), and in which ways it looks for the minimum, one after the other until one finds it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/thread_pool.hpp"
#include "estimation/problem.hpp"
#include "model/measurements.hpp"
#include "sepcal/detail/stage_one.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::estimation {

/// Where stage two stands, over the n free parameters.
struct StageTwo {
  Eigen::VectorXd x;                        // n: xi1, xi2
  Eigen::VectorXd noise;                    // n_z standard deviations
  std::vector<bool> at_bound;               // n
  std::vector<TriangularFactor> factors;    // n_z, [A | D | r] at x, not whitened
  Eigen::VectorXd scale;                    // n, plausible lengths at the factors
  std::optional<Prior> hold;                // a loose prior on what the record leaves open
  SecondStage method = SecondStage::joint;  // joint or projected: what was used in the end
  bool refined = false;                     // x is a minimum at this noise, to the last digit
  bool settled = false;                     // the noise is that of x (Eq. 26), or was given
  double cost = 0.0;                        // J of Eq. 6, without its constant, with the priors
  int iterations = 0;
  int noise_iterations = 0;
  Passes passes;                       // of all attempts
  std::vector<std::string> sentences;  // what a reader has to know

  bool converged() const { return refined && settled; }
};

struct Attempt {
  SecondStage method = SecondStage::joint;  // joint or projected
  double first_radius = 1e4;                // as in DescentOptions
  /// Where the record leaves something open at the start, hold it by a loose prior, jointly.
  bool hold = true;
  /// The start is all but the minimum: it is refined before anything else, and kept where it has to
  /// be held.
  bool near = false;
};

/// The ways from stage one's end, the first of which nearly always is enough. Behind samples: as
/// Step 5 has it, then, if that was `auto`'s projected, joint. A start that was given may be poor,
/// and what the record leaves open there it may determine at the minimum: nothing is held at first.
/// Then follow joint (`auto`) with what is open held, and the first way again with shorter steps.
std::vector<Attempt> list_attempts(const FitOptions& options, const StageOne& start);

/// From the minimum of a neighbouring problem, in which what is open was held or was not.
Attempt from_neighbour(const FitOptions& options, SecondStage method, bool hold);

/// The same by steps so short that the descent ends in the neighbour's basin; nothing is held.
Attempt within_basin(const FitOptions& options, SecondStage method);

/// How an attempt ended.
struct Ending {
  bool converged = false;
  bool open = false;  // the record leaves something open at the end
  bool held = false;  // and a prior held it
  double cost = 0.0;  // J of Eq. 6
};

/// Whether no further attempt is called for: it converged and, from a start that was given, to a
/// point that the record determines.
bool is_enough(const Ending& ending, bool start_given);

/// Whether `next` is to be kept instead of `best`: converged before not, determined before open,
/// held before run away, then the lower cost.
bool is_better(const Ending& next, const Ending& best);

/// Whether both converged and the record can't tell their ends apart: then what they leave open is
/// the record's doing.
bool agree(const Ending& one, const Ending& other);

/// Step 5, from where stage one ended.
StageTwo run_stage_two(const Problem& problem, const model::Measurements& measurements,
                       const StageOne& start, base::ThreadPool& pool);

/// The same in the ways given (at least one), until one of them is enough.
StageTwo run_stage_two(const Problem& problem, const model::Measurements& measurements,
                       const StageOne& start, const std::vector<Attempt>& attempts,
                       base::ThreadPool& pool);

}  // namespace sepcal::estimation
