// SPDX-License-Identifier: BSD-3-Clause
// The residuals of a fit on a record, and what a comparison says of them: of sensors and of
// aircraft.
#pragma once

#include "base/thread_pool.hpp"
#include "sepcal/detail/block_model.hpp"
#include "sepcal/fit.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/flight/flight.hpp"
#include "sepcal/record.hpp"

namespace sepcal::verbs {

/// z - model at the fit, of every row in the record's segments: rows x n_z.
Eigen::MatrixXd residuals_of(const BlockModel& model, const Record& record, const Fit& fit,
                             base::ThreadPool& pool);

/// All but the model's name and the notes. `tables` say which columns are outputs. `channels`: what
/// the residuals may follow, the record's columns or what stands in their place.
Comparison compare_residuals(Eigen::MatrixXd residuals, const Tables& tables, const Record& record,
                             const Record& channels, const Flight& flight, const Fit& fit,
                             base::ThreadPool& pool);

}  // namespace sepcal::verbs
