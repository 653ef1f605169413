// SPDX-License-Identifier: BSD-3-Clause
// What the end of a scoring says, of one record or of many flights: errors of what was estimated,
// what is left open, and noises that are all but none.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "estimation/scoring.hpp"
#include "sepcal/detail/identifiability.hpp"
#include "sepcal/detail/tables.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"

namespace sepcal::estimation {

/// One of what scoring estimates, in the order of Scoring::free.
struct Estimated {
  enum class Kind { parameter, process_noise, output_noise };
  std::string name;   // "Za", "q_alpha", "r_alpha_m"
  Variable variable;  // with the bounds that hold; of a noise that of the table
  Kind kind = Kind::parameter;
};

/// Of the k of those that no bound holds.
struct ScoredErrors {
  std::vector<Eigen::Index> inside;    // their places among the estimated
  Eigen::MatrixXd white;               // k x k, as the others; NaN where the factor is singular
  Eigen::MatrixXd blocks;              // NaN where blocks can't tell
  Eigen::MatrixXd believed;            // white, but for what blocks move much farther
  std::vector<std::string> sentences;  // what a reader has to know
};

/// Factors of score rows by blocks longer than the innovations remember, k + 1 columns: those
/// inside and the residual. None where there are too few of them.
using FindBlocks =
    std::function<std::vector<TriangularFactor>(const std::vector<Eigen::Index>& inside)>;

ScoredErrors find_scored_errors(const Scoring& scoring, const Scored& at,
                                const std::vector<Estimated>& estimated, const FitOptions& options,
                                const FindBlocks& find_blocks);

/// Of the parameters, whatever the noises are: those are told by describe_noises(). Noises at their
/// floors take no part: nothing there depends on them. `whitened_square`: sum of the readings'
/// squares over the outputs' noise. The filter must have gone through.
Identifiability judge_scored(const Scored& at, const std::vector<Estimated>& estimated,
                             double whitened_square);

/// A noise's size with its error, place i among the estimated.
NoiseSize size_of(const Scored& at, const Scoring& scoring, const std::vector<Estimated>& estimated,
                  const ScoredErrors& errors, Eigen::Index i);

/// Why no maximum was reached: the filter stopped at a row, or the steps did not do.
std::string describe_stop(std::size_t row);
std::string describe_no_maximum(const FitOptions& options);

/// Noises that nothing but their floor stopped.
std::vector<std::string> describe_floors(const Scored& at, const Scoring& scoring,
                                         const std::vector<Estimated>& estimated,
                                         const FitOptions& options);

/// Those that are all but none, or that others do for as well.
std::vector<std::string> describe_noises(const std::vector<NoiseSize>& sizes);

}  // namespace sepcal::estimation
