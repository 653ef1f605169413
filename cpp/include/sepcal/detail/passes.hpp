// SPDX-License-Identifier: BSD-3-Clause
// What the time of a fit is made of, counted: a regression is seen without a clock.
#pragma once

namespace sepcal {

/// Passes over the whole record. The samples of stage one, which share one, are not among them.
struct Passes {
  int values = 0;    // of A and b, or of the residual
  int tangents = 0;  // of D as well
};

}  // namespace sepcal
