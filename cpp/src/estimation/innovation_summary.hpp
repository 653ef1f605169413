// SPDX-License-Identifier: BSD-3-Clause
// What a record's innovations amount to, beside their likelihood: sums by output, how long they
// remember, and their score rows by blocks of the record.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/record.hpp"

namespace sepcal::estimation {

/// Sums over the readings that are there, by output (n_z).
struct InnovationSummary {
  Eigen::VectorXd squares;   // of innovations
  Eigen::VectorXd counts;    // readings
  Eigen::VectorXd readings;  // of readings' squares
  double memory = 1.0;       // rows of innovations that count as one (Memory); NaN: not finite

  Eigen::VectorXd rmse() const { return (squares.array() / counts.array().max(1.0)).sqrt(); }

  /// Sum of the readings' squares over the outputs' noise; `sizes`: its standard deviations (n_z).
  double whitened_square(const Eigen::VectorXd& sizes) const {
    return (readings.array() / sizes.array().square()).sum();
  }
};

/// Of a theta that the filter can follow.
InnovationSummary summarise(const InnovationModel& innovations, const BlockModel& model,
                            const Record& record, const Eigen::VectorXd& theta);

/// The factor of these columns of the score rows (size() is the residual's) of each block:
/// `blocks` of them, as long as each other to a row.
std::vector<TriangularFactor> score_blocks(const InnovationModel& innovations, const Record& record,
                                           const Eigen::VectorXd& theta,
                                           const std::vector<Eigen::Index>& columns, int blocks);

/// -ln L less V_m.
double likelihood_constant(std::size_t readings);

}  // namespace sepcal::estimation
