// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/residual_noise.hpp"

#include <cmath>

#include "numerics/tails.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Correlations of rows `lag` apart, within runs, about the mean.
VectorXd autocorrelation(const VectorXd& e, const std::vector<Segment>& runs, Index lags) {
  const VectorXd centred = e.array() - e.mean();
  VectorXd correlation = VectorXd::Zero(lags);
  for (Index lag = 1; lag <= lags; ++lag) {
    for (const Segment& run : runs) {
      const Index pairs = static_cast<Index>(run.rows()) - lag;
      if (pairs <= 0) continue;
      const auto first = static_cast<Index>(run.first);
      correlation[lag - 1] +=
          centred.segment(first, pairs).dot(centred.segment(first + lag, pairs));
    }
  }
  return correlation / centred.squaredNorm();
}

}  // namespace

std::vector<ResidualNoise> describe_residual(const NullHypothesis& null) {
  constexpr Index lags = 20;
  const RowLayout& layout = null.fit().layout;
  const auto rows = static_cast<double>(layout.rows);
  std::vector<ResidualNoise> described;
  for (std::size_t j = 0; j < layout.outputs.size(); ++j) {
    const UsedOutput& output = layout.outputs[j];
    const VectorXd e = null.fit().residual.segment(layout.first(j), layout.rows);
    ResidualNoise noise{.output = output.name,
                        .unit = output.unit,
                        .rmse = output.scale,
                        .lag_one = not_a_number,
                        .ljung_box_p = not_a_number,
                        .noise = null.best.noise[j]};
    if (layout.rows > 2 * lags) {
      const VectorXd r = autocorrelation(e, layout.runs, lags);
      double Q = 0.0;
      for (Index k = 1; k <= lags; ++k) {
        Q += r[k - 1] * r[k - 1] / (rows - static_cast<double>(k));
      }
      noise.lag_one = r[0];
      noise.ljung_box_p = std::pow(10.0, numerics::log10_chi_squared_tail(
                                             rows * (rows + 2.0) * Q, static_cast<double>(lags)));
    }
    noise.noise.sigma *= output.scale;
    noise.floor = noise.noise.sigma;
    described.push_back(noise);
  }
  return described;
}

}  // namespace sepcal::diagnosis
