// SPDX-License-Identifier: BSD-3-Clause
// What a trial's end is worth: its white standard errors, and whether the record determines it, as
// fit() would say.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "estimation/problem.hpp"
#include "many/trial_lanes.hpp"

namespace sepcal::many {

class TrialErrors {
 public:
  /// `rows`: of a trial, more measurements than parameters.
  TrialErrors(const estimation::Problem& problem, std::size_t rows);

  /// A message, empty where there is nothing to say; none where the record may leave something
  /// open.
  std::optional<std::string> judge(const TrialEnd& end);

  /// Of the end that was judged last: n free parameters.
  const Eigen::VectorXd& standard_errors() const { return errors_; }

 private:
  void invert(const Eigen::MatrixXd& R);
  std::optional<std::string> identify(const TrialEnd& end) const;

  double ratio_;                    // of standard errors to those of R as it is
  Eigen::VectorXd half_widths_;     // n; infinite without two bounds
  std::vector<std::string> names_;  // n
  Eigen::MatrixXd inverse_;         // n x n
  Eigen::VectorXd scale_;           // n, plausible lengths
  Eigen::VectorXd errors_;          // n
};

}  // namespace sepcal::many
