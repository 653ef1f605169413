// SPDX-License-Identifier: BSD-3-Clause
#include "noise/stationary_lags.hpp"

#include <algorithm>

#include "noise/noise_autocovariance.hpp"
#include "noise/noise_room.hpp"
#include "numerics/toeplitz.hpp"

namespace sepcal::noise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

/// V(0), ..., V(most) of differences with autocovariance gamma (most of them or more).
VectorXd find_variogram(const VectorXd& gamma, Index most) {
  VectorXd variogram = VectorXd::Zero(most + 1);
  double slope = gamma[0];
  for (Index h = 0; h < most; ++h) {
    if (h > 0) slope += 2.0 * gamma[h];
    variogram[h + 1] = variogram[h] + slope;
  }
  return variogram;
}

}  // namespace

StationaryLags::StationaryLags(const NoiseModel& model, const std::vector<Index>& lengths)
    : variance_(model.sigma * model.sigma), free_(model.level_is_free()) {
  check_noise_model(model);
  const Index longest = lengths.empty() ? 0 : *std::ranges::max_element(lengths);
  lags_ = find_moments(model.d - (free_ ? 1.0 : 0.0), model.phi, 2 * longest).autocovariance;
  if (free_) lags_ = find_variogram(lags_, 2 * longest);
}

MatrixXd StationaryLags::multiply(const Ref<const MatrixXd>& X, Index run_rows,
                                  Index offset) const {
  const MatrixXd by_lag = numerics::multiply_toeplitz(lags_, X);
  if (!free_) return variance_ * by_lag;
  // The run's first row follows run_rows - 1 steps after a row at zero.
  const auto since = lags_.segment(run_rows + offset, X.rows());
  const MatrixXd begun = since * X.colwise().sum();
  const Eigen::RowVectorXd ended = since.transpose() * X;
  return 0.5 * variance_ * ((begun - by_lag).rowwise() + ended);
}

}  // namespace sepcal::noise
