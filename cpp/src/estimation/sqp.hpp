// SPDX-License-Identifier: BSD-3-Clause
// NLopt's SLSQP: sequential quadratic programming, which sees the cost and its gradient alone. It
// takes more evaluations than Levenberg-Marquardt, and keeps moving along bounds where that one,
// whose steps are clipped to the box, stands still.
#pragma once

#include "estimation/minimise.hpp"

namespace sepcal::estimation {

struct SqpOptions {
  double rows = 1.0;  // the solver sees S / 2 over so many: its tolerances take a cost of order one
  int evaluations = 1000;
};

/// x stays within the box; the start is clipped to it. `widths` (n): what the solver takes for one.
Descent descend_by_sqp(Objective& objective, const Eigen::VectorXd& start, const numerics::Box& box,
                       const Eigen::VectorXd& widths, const SqpOptions& options);

}  // namespace sepcal::estimation
