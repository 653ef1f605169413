// SPDX-License-Identifier: BSD-3-Clause
// Every choice of how a state model is laid along a record, with its default.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sepcal/detail/quantity.hpp"
#include "sepcal/detail/states/inputs_between_rows.hpp"

namespace sepcal {

/// "linear", "hold".
constexpr std::string_view to_string(InputsBetweenRows inputs) {
  return inputs == InputsBetweenRows::linear ? "linear" : "hold";
}

struct TrajectoryOptions {
  InputsBetweenRows inputs = InputsBetweenRows::linear;
  /// Runge-Kutta steps from row to row: more where dt |lambda_max(df/dx)| > 0.5.
  int substeps = 1;
  /// Multiple shooting: a segment is cut every so many seconds, and every piece has initial states
  /// of its own. For what runs away over a whole segment, as an unstable aircraft does.
  double shoot = infinity;
  /// States that are read from columns of their names instead of being integrated.
  std::vector<std::string> measured = {};
  /// The outputs that are measured; empty: all of the model's. A linear parameter that acts on none
  /// of them leaves with the others.
  std::vector<std::string> outputs = {};
  /// Of a model with a table `linear_dynamic`: those parameters and the initial states are linear.
  bool separable = true;
  /// A scale multiplies the change of its output since the segment's start, y - y(0), and not y
  /// itself, as SIDPAC has it: the same scale, with a bias that differs by lambda y(0).
  bool scales_about_start = false;
};

}  // namespace sepcal
