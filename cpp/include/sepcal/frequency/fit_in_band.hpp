// SPDX-License-Identifier: BSD-3-Clause
// Complex least squares over a band (Morelli & Klein, Aircraft System Identification, Sec. 7.2): a
// model that is linear in its parameters holds for the transforms of its columns as it does row by
// row, and the transforms leave out what lies beyond the band: differentiation's noise above, drift
// and trim below. Constants come from the means of the rows.
#pragma once

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/frequency/transform.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// z = A xi1 + b over the band, segment by segment. Of the result `rows` are the record's;
/// `rmse` is over these rows in time, and so is `noise` where it was not given: the page of a
/// comparison is in time.
///
/// Standard errors are of the residual's own spectrum, smoothed over nine independent frequencies,
/// and allow for frequencies that are closer than independent ones; `standard_error_white` takes
/// the spectrum for level within the band. FitOptions::coloured_errors false believes the white
/// ones. A constant's are as though the spectrum went on to zero as at the band's low end.
///
/// Throws Error for a model with nonlinear parameters, a record without `time`, a loss other than
/// squares, and as frequencies_of() does for its segments.
Fit fit_in_band(const BlockModel& model, const Record& record, const Band& band,
                const FitOptions& options = {});

}  // namespace sepcal
