// SPDX-License-Identifier: BSD-3-Clause
// Noise taken from samples by least squares: a cubic spline whose even knots lie farther apart than
// the samples. Least squares project, so that what is left has no part in the spline and moves
// nowhere when the spline is read at other times; a smoothing spline's rest does.
#pragma once

#include <span>
#include <vector>

namespace sepcal::numerics {

/// Samples between two gaps: as many values as times, which increase.
struct Stretch {
  std::span<const double> times;
  std::span<const double> values;
};

/// The knots' spacing, in the unit of time, at which generalised cross-validation (Craven and
/// Wahba 1979) of all stretches is least; 0 where no smoothing predicts better than the finest, as
/// where there is no noise or its neighbours resemble each other.
double choose_spacing(const std::vector<Stretch>& stretches, double interval);

/// The spline's values at the times of its samples; they themselves where they are too few for it.
std::vector<double> fit_spline(const Stretch& stretch, double spacing);

}  // namespace sepcal::numerics
