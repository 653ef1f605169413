// SPDX-License-Identifier: BSD-3-Clause
// Seeded draws of xi2 within its bounds (Sun & Gebre-Egziabher, Step 2). All draws are made up
// front and in order: the same seed gives the same samples on any machine and any number of
// threads.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/options.hpp"
#include "sepcal/record.hpp"

namespace sepcal::estimation {

/// n_2 x S. `parameters` are the nonlinear ones with their bounds, in order. One with a
/// sampling distribution is drawn from that normal, truncated to its bounds. Throws Error for a
/// parameter that has neither finite bounds nor a sampling distribution, or one without weight
/// within the bounds.
Eigen::MatrixXd draw_samples(const std::vector<Variable>& parameters, const FitOptions& options);

/// The point that stage two starts from where nothing was sampled (n_2): options.start, else the
/// mean of the sampling distribution, else the middle of the bounds, or the bound or zero that is
/// nearest where one is infinite.
Eigen::VectorXd nominal_point(const std::vector<Variable>& parameters, const FitOptions& options);

/// The options with what the model itself says of where to begin (BlockModel::starting_values()):
/// among `start` where there is one, or where nothing else is free, else `unsampled`. What the
/// options say of a parameter goes before it. Parameters on which nothing in the selected segments
/// depends are held there.
FitOptions with_starting_values(const BlockModel& model, const Record& record,
                                const std::string& segments, FitOptions options);

}  // namespace sepcal::estimation
