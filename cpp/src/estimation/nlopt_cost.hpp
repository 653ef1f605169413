// SPDX-License-Identifier: BSD-3-Clause
// The one door to NLopt: an objective's sum of squares S, or a function of it, with its gradient.
#pragma once

#include <Eigen/Core>
#include <exception>
#include <functional>
#include <nlopt.hpp>
#include <vector>

#include "estimation/minimise.hpp"
#include "estimation/objective.hpp"

namespace sepcal::estimation {

/// What the solver sees of S.
struct SquareScale {
  SquareScale() = default;
  SquareScale(const SquareScale&) = delete;
  SquareScale& operator=(const SquareScale&) = delete;
  virtual ~SquareScale() = default;
  virtual double value(double square) const = 0;  // also of a sum that is not finite
  virtual double slope(double square) const = 0;  // by S
};

std::vector<double> values_in(const Eigen::VectorXd& x);

/// It and its gradient as one of NLopt's functions, of x from `origin` in units of `widths`.
class NloptCost {
 public:
  NloptCost(Objective& objective, const SquareScale& scale, Eigen::VectorXd origin,
            Eigen::VectorXd widths);

  Eigen::VectorXd point(const std::vector<double>& t) const;

  /// The lowest point so far, with the count of evaluations as its iterations.
  const Descent& lowest() const { return lowest_; }

  /// Calls `on_point` with x and S at every evaluation.
  void hear(std::function<void(const Eigen::VectorXd& x, double square)> on_point);

  /// Runs the solver from t. An exception of the model stops it and is thrown again here: NLopt is
  /// written in C and lets none through. False where the solver ran out of evaluations or failed.
  bool minimise(nlopt::opt& solver, std::vector<double> t);

 private:
  static double evaluate(const std::vector<double>& t, std::vector<double>& gradient, void* self);
  double at(const std::vector<double>& t, std::vector<double>& gradient);
  /// S, and its gradient 2 J'r in the scale's measure, times the widths.
  double differentiate(const Eigen::VectorXd& x, std::vector<double>& gradient);

  Objective& objective_;
  const SquareScale& scale_;
  Eigen::VectorXd origin_;
  Eigen::VectorXd widths_;
  Descent lowest_;
  std::function<void(const Eigen::VectorXd&, double)> on_point_;
  std::exception_ptr failure_;
};

}  // namespace sepcal::estimation
