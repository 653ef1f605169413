// SPDX-License-Identifier: BSD-3-Clause
// Candidates that the residual itself asks for: where along a channel a curve or a few levels at a
// port explain clearly more than a straight line.
#pragma once

#include <string>
#include <vector>

#include "base/thread_pool.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::verbs {

/// Names `port[spline(channel,k)]` and `port[levels(channel,...)]`, a few, the most telling first;
/// along time splines alone.
/// One pass over the rows sums, a bin of a channel, what a constant at each port would explain
/// there; every curve is then judged by those sums. `channels`: columns of the fit's record.
std::vector<std::string> find_curved(const DiagnosedFit& fitted,
                                     const std::vector<std::string>& channels,
                                     base::ThreadPool& pool);

}  // namespace sepcal::verbs
