// SPDX-License-Identifier: BSD-3-Clause
// The whole problem in plain dense matrices, derivatives by differences: what the streamed,
// compressed engine is held against. Rows stand output by output, n_z * N of them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::test {

/// [A | b] of every selected row, (n_z * N) x (n_1 + 1), one segment at a time.
Eigen::MatrixXd dense_values(const BlockModel& model, const Record& record,
                             const Eigen::VectorXd& xi2);

/// z (n_z * N).
Eigen::VectorXd dense_outputs(const BlockModel& model, const Record& record);

/// A xi1 + b (n_z * N).
Eigen::VectorXd dense_prediction(const BlockModel& model, const Record& record,
                                 const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2);

/// [A | D | r], D by Richardson's extrapolation of central differences (error about 1e-11).
Eigen::MatrixXd dense_rows(const BlockModel& model, const Record& record,
                           const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2);

/// d(A xi1 + b)/du of the chosen inputs (n_z * N x inputs): as the model gives it, and by
/// Richardson's extrapolation of central differences.
struct InputTangents {
  Eigen::MatrixXd given;
  Eigen::MatrixXd numeric;
};
InputTangents input_tangents(const BlockModel& model, const Record& record,
                             const Eigen::VectorXd& xi1, const Eigen::VectorXd& xi2,
                             const std::vector<int>& inputs);

/// Every row divided by its output's noise standard deviation.
Eigen::MatrixXd whiten(Eigen::MatrixXd rows, const Eigen::VectorXd& noise);

}  // namespace sepcal::test
