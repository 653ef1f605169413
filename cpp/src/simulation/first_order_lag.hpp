// SPDX-License-Identifier: BSD-3-Clause
// A reading that follows its input late, tau dy/dt + y = u, for the simulators. u is known at any
// time; over steps of at most 5 ms it is taken for a parabola, and the equation is solved exactly.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

namespace sepcal::simulation {

class FirstOrderLag {
 public:
  using Input = std::function<Eigen::VectorXd(double time)>;

  /// At rest long before `begin` [s]. tau = 0 gives u itself. Throws Error, opened by `effect`, for
  /// a tau below 0 or above 2 s.
  FirstOrderLag(const std::string& effect, double tau, double begin, Input input);

  /// y at a time [s] that is no earlier than the last one asked for.
  Eigen::VectorXd advance_to(double time);

 private:
  void step(double length);

  double tau_;
  Input input_;
  double time_;
  Eigen::VectorXd now_;     // u at time_
  Eigen::VectorXd output_;  // y at time_
};

}  // namespace sepcal::simulation
