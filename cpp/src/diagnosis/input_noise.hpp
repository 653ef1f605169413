// SPDX-License-Identifier: BSD-3-Clause
// White noise of what enters a model, as of a probe's pressures or of an attitude: it comes into
// several outputs of a row at once, each by its slope there. Tests that take outputs for
// independent and each for equally loud all along are then surer than they may be.
#pragma once

#include <Eigen/Core>

namespace sepcal::diagnosis {

class InputNoise {
 public:
  /// `white`: whitened residuals of the outputs, N x m; `slopes`: what a unit of each input does,
  /// output after output (m N x inputs). The covariance of a row is a sum of the outputs' own
  /// variances and of those of the inputs, by least squares of the products of the outputs.
  InputNoise(const Eigen::MatrixXd& white, Eigen::MatrixXd slopes);

  /// The outputs of each row multiplied by the inverse root of its covariance: independent, and of
  /// unit size. Without inputs as they are.
  Eigen::MatrixXd take_out(const Eigen::MatrixXd& white) const;

  /// How many times as far columns (m N x q) are thrown about as by noise that is independent in
  /// each output and equally loud all along, a ratio of variances; at least 1. Of several columns
  /// as Satterthwaite's approximation has it.
  double inflation(const Eigen::MatrixXd& columns) const;

 private:
  bool is_known() const { return slopes_.cols() > 0; }
  Eigen::MatrixXd slopes_of(Eigen::Index row) const;

  Eigen::Index rows_;
  Eigen::MatrixXd slopes_;  // each of unit rms
  Eigen::VectorXd own_;     // variances of the outputs' own noise (m)
  Eigen::VectorXd inputs_;  // and of the inputs'
};

}  // namespace sepcal::diagnosis
