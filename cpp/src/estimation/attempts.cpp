// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/attempts.hpp"

#include <cmath>
#include <tuple>

namespace sepcal::estimation {
namespace {

// First radii. One over them is Marquardt's damping of columns of unit length.
constexpr double gauss_newton = 1e4;  // the first step is all but Gauss-Newton's
constexpr double customary = 1e3;     // a damping of 0.001, the customary first one
constexpr double short_steps = 10.0;
constexpr double within_the_basin = 0.1;  // a fraction of Gauss-Newton's, as in stage one

/// A loss is minimised jointly.
SecondStage possible(const FitOptions& options, SecondStage method) {
  return options.loss == Loss::squares ? method : SecondStage::joint;
}

}  // namespace

std::vector<Attempt> list_attempts(const FitOptions& options, const StageOne& start) {
  const SecondStage asked = possible(options, options.second_stage);
  const bool automatic = asked == SecondStage::automatic;
  const bool separable = start.xi1.size() > 0;
  if (options.start.empty()) {
    if (!automatic) return {{asked}};
    if (!start.unique_minimum) return {{SecondStage::joint}};
    return {{SecondStage::projected}, {SecondStage::joint}};
  }
  const SecondStage method = !automatic  ? asked
                             : separable ? SecondStage::projected
                                         : SecondStage::joint;
  return {{method, customary, false},
          {automatic ? SecondStage::joint : method, gauss_newton, true},
          {method, short_steps, false},
          {method, within_the_basin, false}};
}

Attempt from_neighbour(const FitOptions& options, SecondStage method, bool hold) {
  return {possible(options, method), customary, hold, true};
}

Attempt within_basin(const FitOptions& options, SecondStage method) {
  return {possible(options, method), within_the_basin, false};
}

bool is_enough(const Ending& ending, bool start_given) {
  return ending.converged && !(start_given && ending.open);
}

bool is_better(const Ending& next, const Ending& best) {
  const auto merits = [](const Ending& ending) {
    return std::tuple(ending.converged, !ending.open, ending.held);
  };
  if (merits(next) != merits(best)) return merits(next) > merits(best);
  return next.cost < best.cost;
}

bool agree(const Ending& one, const Ending& other) {
  constexpr double one_standard_error = 0.5;  // of J
  return one.converged && other.converged && std::abs(one.cost - other.cost) <= one_standard_error;
}

}  // namespace sepcal::estimation
