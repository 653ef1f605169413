// SPDX-License-Identifier: BSD-3-Clause
// Recursive least squares of any number of parameters; for flight, of fixed size, InformationRoot.
#pragma once

#include <Eigen/Core>

#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::states {

/// U, U'U = (R'R)^-1, upper triangular (k x k).
Eigen::MatrixXd covariance_root(const Eigen::MatrixXd& R);

/// Rows [H | r] behind [R 0]: corrections of a fixed point.
class InformationTrack {
 public:
  explicit InformationTrack(const Eigen::MatrixXd& R);
  /// False, and nothing absorbed, where a number is not finite.
  bool absorb(const Eigen::MatrixXd& sample);
  /// What a sample brings beyond what is expected of it, of unit covariance where it is as noisy
  /// as its rows say.
  Eigen::VectorXd whitened(const Eigen::MatrixXd& sample) const;
  /// All that was absorbed counts for so much less: R'R by it.
  void forget(double by);
  Eigen::VectorXd solution() const;    // k
  Eigen::VectorXd deviations() const;  // k
  Eigen::MatrixXd root() const;        // k x k

 private:
  TriangularFactor factor_;
};

}  // namespace sepcal::states
