// SPDX-License-Identifier: BSD-3-Clause
// The one door to NLopt: a global search of a box by dividing it (DIRECT: Jones, Perttunen and
// Stuckman 1993), and local descents with exact gradients (SLSQP: Kraft 1994). Both see ln S, S
// the sum of squares: neither units nor the length of the record matter, and depths are ratios.
// Neither draws random numbers, and NLopt keeps no state between calls: equal questions get equal
// answers, from any number of threads.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "estimation/minimise.hpp"
#include "estimation/objective.hpp"
#include "sepcal/detail/tables.hpp"

namespace sepcal::estimation {

/// Every point at which a global search asked for the cost, in its order.
struct SearchedPoints {
  Eigen::MatrixXd points;   // n x S
  Eigen::VectorXd squares;  // S; not finite where the model is not
};

/// At most `evaluations` points, as many but for a box that can't be divided further. `parameters`
/// (n) have the bounds. Where the model is not finite, the search turns away. `on_progress` hears
/// the fraction done. Throws Error for a bound that is not finite, and what the objective throws.
SearchedPoints search_globally(Objective& objective, const std::vector<Variable>& parameters,
                               int evaluations, const std::function<void(double)>& on_progress);

/// From `start` to the bottom of its basin within the box. The first steps stay within a twentieth
/// of `widths` (n); where they end at that limit, twice as far is tried, and so on. Ends when a
/// step changes S by less than 1e-10 of itself or x by less than 1e-8 of `widths`, or after 200
/// evaluations a try (not converged). Throws what the objective throws.
Descent descend(Objective& objective, const Eigen::VectorXd& start, const numerics::Box& box,
                const Eigen::VectorXd& widths);

}  // namespace sepcal::estimation
