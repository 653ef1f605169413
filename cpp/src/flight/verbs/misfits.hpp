// SPDX-License-Identifier: BSD-3-Clause
// What a residual comes to: as a whole, and part by part of its flight.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/diagnosis.hpp"
#include "sepcal/flight/comparison.hpp"
#include "sepcal/record.hpp"

namespace sepcal::verbs {

/// `residuals`: rows x n_z, of the rows in the record's segments, one after another; NaN where
/// there is no reading. One misfit an output, over all rows.
std::vector<Misfit> measure_whole(const Record& record, const std::vector<Variable>& outputs,
                                  const Eigen::MatrixXd& residuals);

/// The same by label where there are two, else over ten spans of time; part by part, outputs
/// within.
std::vector<Misfit> measure_parts(const Record& record, const std::vector<Variable>& outputs,
                                  const Eigen::MatrixXd& residuals);

/// The same of the rows that were fitted.
std::vector<Misfit> measure_parts(const DiagnosedFit& fitted);

}  // namespace sepcal::verbs
