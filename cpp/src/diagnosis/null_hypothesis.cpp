// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/null_hypothesis.hpp"

#include "diagnosis/held_out.hpp"
#include "diagnosis/projection.hpp"

namespace sepcal::diagnosis {

using Eigen::MatrixXd;
using Eigen::VectorXd;

NullHypothesis find_null(const Linearisation& fit) {
  NullHypothesis null{.fit = &fit};
  null.basis = orthonormal_basis(fit.tangent);
  const VectorXd residual = remove_span(null.basis, fit.residual);
  const NoiseModels noise = fit_noise_models(fit.layout, residual);
  null.best = maximise(fit.layout, null.basis, residual, {noise, forget_colour(noise)});
  MatrixXd white = join(null.basis, residual);
  whiten(fit.layout, null.best.noise, white);
  null.white_basis = orthonormal_basis(white.leftCols(null.basis.cols()));
  null.white_residual = remove_span(null.white_basis, white.rightCols<1>());
  std::vector<int> orders;
  for (const NoiseModel& model : null.best.noise) orders.push_back(model.order());
  null.test = std::make_shared<const NoiseTest>(fit, null.basis, std::move(orders));
  return null;
}

double predict_drop(const NullHypothesis& null, const MatrixXd& added) {
  const Linearisation& fit = *null.fit;
  const VectorXd left = remove_span(added, remove_span(null.basis, fit.residual));
  return 1.0 - total_rmse(fit.layout, left) / total_rmse(fit.layout, fit.residual);
}

}  // namespace sepcal::diagnosis
