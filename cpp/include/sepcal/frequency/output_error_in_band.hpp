// SPDX-License-Identifier: BSD-3-Clause
// Output error over a band (Morelli & Klein, Aircraft System Identification, Sec. 7.3): a model
// with a state, linear about the flight's means, algebra at each frequency in place of integration:
//   (z I - Phi) X = (Gamma_0 + z Gamma_1) U + z w_0 c,   Y = H X + D U,   z = exp(j w dt),
// x and u as deviations, Phi and Gamma those of a step between rows. At multiples of one over a
// segment's length constants vanish, biases and trim among them, and of the ends nothing is left
// but c, what state and input are further at its end than at its start: linear, n_x a segment.
#pragma once

#include "sepcal/detail/frequency/transform.hpp"
#include "sepcal/detail/states/state_steps.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// Parameters: c, as `q_end` or `q_end[2]` of each segment where there are several, then what moves
/// the states; no biases, scales or initial states. Standard errors are fit_in_band()'s; `rmse` and
/// `noise` are of the band, in the size that a white noise of the rows would have there.
///
/// Throws Error for a record without `time` or whose rows are not evenly spaced to a tenth of a
/// step, a spacing of the band, a loss other than squares, and as frequencies_of() does for its
/// segments.
Fit fit_output_error_in_band(const StateBlockModel& model, const Record& record, const Band& band,
                             const FitOptions& options = {});

}  // namespace sepcal
