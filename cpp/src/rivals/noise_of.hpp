// SPDX-License-Identifier: BSD-3-Clause
// R of the residuals, as the rivals take it in turn with the parameters (Eq. 25).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "model/measurements.hpp"

namespace sepcal::rivals {

/// Standard deviations of outputs (n_z) by their sums of squares, above zero: that of an output
/// without any noise would end every later minimisation.
inline Eigen::VectorXd noise_of(const Eigen::VectorXd& squares,
                                const model::Measurements& measurements) {
  constexpr double least = 1e-12;  // of the measurements' root mean square, or of 1 where that is 0
  const auto rows = static_cast<double>(measurements.rows());
  Eigen::VectorXd noise(squares.size());
  for (Eigen::Index j = 0; j < noise.size(); ++j) {
    const double measured = std::sqrt(measurements.output_square(static_cast<int>(j)) / rows);
    noise[j] = std::max(std::sqrt(squares[j] / rows), least * (measured > 0.0 ? measured : 1.0));
  }
  return noise;
}

}  // namespace sepcal::rivals
