// SPDX-License-Identifier: BSD-3-Clause
// The covariance of a noise model over a run of rows, by lags: of noise with a level of its own
// their autocovariance; where the level is free the noise is zero n rows before a run of n rows,
// and with V(h) the variance of its change over h rows
//   cov(e_s, e_t) = [V(s + n) + V(t + n) - V(|t - s|)] / 2.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sepcal/noise_model.hpp"

namespace sepcal::noise {

class StationaryLags {
 public:
  /// `lengths`: rows of each run. Throws Error as Whitener does, but sigma may be 0.
  StationaryLags(const NoiseModel& model, const std::vector<Eigen::Index>& lengths);

  /// S X (rows x q) of rows of a run of `run_rows` from its row `offset` on, S their covariance.
  Eigen::MatrixXd multiply(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::Index run_rows,
                           Eigen::Index offset) const;

 private:
  double variance_;
  bool free_;
  Eigen::VectorXd lags_;  // autocovariance, or V where the level is free
};

}  // namespace sepcal::noise
