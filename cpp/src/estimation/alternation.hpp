// SPDX-License-Identifier: BSD-3-Clause
// R and the parameters in turn (Sun & Gebre-Egziabher, Step 5, Eqs. 24-26): one loop for the fit of
// one flight and for that of many.
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "estimation/acceleration.hpp"
#include "sepcal/options.hpp"

namespace sepcal::estimation {

/// The largest relative change of a variance (Eq. 26).
inline double change_of_variance(const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
  return (after.cwiseQuotient(before).array().square() - 1.0).abs().maxCoeff();
}

/// Steps `at` until R settles; ends with the R of the parameters that it returns. Point has
/// `noise` (the deviations of R), `refined` (the parameters are a minimum at its R), `settled`
/// (Eq. 26) and `noise_iterations`. Stage has
///   bool noise_given()                  R is known and stays
///   Point find_minimum(Point)           the parameters at the first R, from a start
///   Point follow_minimum(Point)         the parameters at another R, from the minimum at the last
///   VectorXd noise_at(const Point&)     R at the parameters (Eq. 25)
///   void take_noise(Point&, VectorXd)   another R from now on
template <class Stage, class Point>
Point alternate(Stage& stage, Point at, const FitOptions& options) {
  constexpr int most_failures = 3;  // then another R will not help
  at = stage.find_minimum(std::move(at));
  at.settled = stage.noise_given();
  int failures = at.refined ? 0 : 1;
  int updates = 0;
  Acceleration acceleration;
  while (!at.settled && failures < most_failures && updates < options.noise_iterations) {
    const Eigen::VectorXd found = stage.noise_at(at);
    at.settled = change_of_variance(at.noise, found) < options.noise_tolerance;
    stage.take_noise(at, at.settled ? found : acceleration.next(at.noise, found));
    ++updates;
    if (options.progress) {
      options.progress("stage two", static_cast<double>(updates) / options.noise_iterations);
    }
    if (at.settled) break;
    at = stage.follow_minimum(std::move(at));
    if (!at.refined) ++failures;
  }
  if (!at.settled) stage.take_noise(at, stage.noise_at(at));
  at.noise_iterations += updates;
  return at;
}

/// Why the point that alternate() ended at did not converge, if it did not, in sentences; `where`
/// to look, behind what is looked for: " in one of the flights", or nothing.
template <class Point>
std::vector<std::string> explain(const Point& end, const FitOptions& options,
                                 const std::string& where = "") {
  if (!end.refined) {
    return {"the minimisation did not converge: no minimum was found near where it ended",
            "look for a wrong unit or sign" + where + ", or bounds that are too wide"};
  }
  if (end.settled) return {};
  return {"R did not settle within " + std::to_string(options.noise_iterations) + " iterations"};
}

}  // namespace sepcal::estimation
