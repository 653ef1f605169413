// SPDX-License-Identifier: BSD-3-Clause
// A refining step's verdict: how long it is, in standard errors and in plausible lengths, and
// whether that is as short as rounding allows.
#pragma once

#include <Eigen/Core>

namespace sepcal::estimation {

struct StepLength {
  double size = 0.0;      // |J step|, in standard errors
  double relative = 0.0;  // the largest entry of the step over the parameter's plausible length
  double residual = 0.0;  // |r|, whitened

  StepLength(double size_, const Eigen::VectorXd& step, const Eigen::VectorXd& scale,
             double residual_)
      : size(size_),
        relative(step.cwiseQuotient(scale).cwiseAbs().maxCoeff()),
        residual(residual_) {}

  bool is_last_digit() const { return size <= 1e-12 * (1.0 + residual) || relative <= 1e-14; }
  bool is_passable() const { return size <= 1e-3 || relative <= 1e-9; }
};

}  // namespace sepcal::estimation
