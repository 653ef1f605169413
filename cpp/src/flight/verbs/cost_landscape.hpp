// SPDX-License-Identifier: BSD-3-Clause
// Stage one's cost over a calibration's nonlinear parameters: Tr[R] at xi2, the linear ones solved
// (Sun & Gebre-Egziabher, Figs. 2, 4 and 6), for pictures.
#pragma once

#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/tables.hpp"
#include "sepcal/flight/calibration.hpp"

namespace sepcal {

struct CostLandscape {
  std::vector<Variable> parameters;  // n that are free, with their bounds
  /// n x S: of one parameter 201 even values, of two a grid of 41 by 41, the first parameter
  /// running fastest, of more 2000 draws of a low-discrepancy sequence; of over 100,000 rows a
  /// quarter.
  Eigen::MatrixXd points;
  Eigen::VectorXd trace_r;  // S; infinite where the model is not finite
};

/// Over the bounds of the fit, the parameters of effects held at their estimates. Nothing, n = 0,
/// where nothing nonlinear is free or a bound is infinite. Throws Error for bad input, as
/// compare().
CostLandscape find_cost_landscape(const Calibration& calibration, const Flight& flight);

}  // namespace sepcal
