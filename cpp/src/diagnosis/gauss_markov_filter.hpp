// SPDX-License-Identifier: BSD-3-Clause
// White noise beside errors that wander, as a Kalman filter. Its gains do not depend on what is
// filtered: they are found once, and columns are then whitened side by side.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sepcal::diagnosis {

/// An error that wanders: a Gauss-Markov process, and what it does to the outputs.
struct GaussMarkovState {
  double variance = 0.0;
  double time = 0.0;  // correlation time [s], or
  double rows = 0.0;  // in rows, where that is not 0
  /// What a unit of it does to each output of each row, output after output; nullptr: as much to
  /// `output`, and nothing to the others.
  const Eigen::VectorXd* slopes = nullptr;
  Eigen::Index output = 0;
};

class GaussMarkovFilter {
 public:
  /// `white`: the variance of each output's white noise (m); `times`: of each row [s] (N).
  GaussMarkovFilter(const std::vector<GaussMarkovState>& states, const Eigen::VectorXd& white,
                    const std::vector<double>& times);

  /// The innovations of columns (m N x q, output after output), each over its standard deviation:
  /// m N x q, by time, the outputs of a row side by side.
  Eigen::MatrixXd whiten(const Eigen::MatrixXd& columns) const;

  /// The log of the determinant of the covariance.
  double log_determinant() const { return -2.0 * roots_.array().log().sum(); }

 private:
  using ByRow = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Eigen::Index states_;    // of columns below, filled up to whole quads
  ByRow decays_;           // of each state from the row before (N)
  ByRow slopes_;           // (m N)
  ByRow gains_;            // (m N)
  Eigen::VectorXd roots_;  // one over the innovations' standard deviation (m N)
};

}  // namespace sepcal::diagnosis
