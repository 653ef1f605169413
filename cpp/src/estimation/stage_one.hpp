// SPDX-License-Identifier: BSD-3-Clause
// Stage one as fit() runs it: on a checked problem, on rows that stand ready.
#pragma once

#include "base/thread_pool.hpp"
#include "estimation/problem.hpp"
#include "model/measurements.hpp"
#include "sepcal/detail/stage_one.hpp"

namespace sepcal::estimation {

/// Steps 2-4. `measurements`: the rows that options.stage_one_segments select.
StageOne run_stage_one(const Problem& problem, const model::Measurements& measurements,
                       base::ThreadPool& pool);

}  // namespace sepcal::estimation
