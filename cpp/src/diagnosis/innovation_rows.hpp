// SPDX-License-Identifier: BSD-3-Clause
// The rows of a fit by filter error: innovations over the root of their covariance, which are white
// where nothing is missing, and what the parameters do to them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "sepcal/detail/path_model.hpp"
#include "sepcal/fit.hpp"

namespace sepcal::diagnosis {

/// Of a fit by filter error the noise that it found; nothing of another one.
std::optional<PathNoise> noise_of(const Fit& fit, const BlockModel& model);

/// [d w/d xi | w], n_z * N rows, output by output; columns of the parameters (n), the last one the
/// residual's. Throws Error where the filter can't go on.
Eigen::MatrixXd innovation_rows(const BlockModel& model, const Record& rows,
                                const Eigen::VectorXd& xi, const PathNoise& noise,
                                std::vector<Eigen::Index> columns);

}  // namespace sepcal::diagnosis
