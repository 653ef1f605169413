// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/null_hypothesis.hpp"

#include <utility>

#include "diagnosis/held_out.hpp"
#include "diagnosis/projection.hpp"

namespace sepcal::diagnosis {

using Eigen::MatrixXd;
using Eigen::VectorXd;
namespace {

void whiten_null(NullHypothesis& null) {
  MatrixXd white = null.basis.columns().dense(null.fit().layout);
  null.whiten(white);
  null.white_basis = orthonormal_basis(std::move(white));
  white = null.residual;
  null.whiten(white);
  null.white_residual = remove_span(null.white_basis, white);
}

}  // namespace

void NullHypothesis::whiten(MatrixXd& columns) const {
  const RowLayout& layout = fit().layout;
  for (std::size_t j = 0; j < whiteners.size(); ++j) {
    whiteners[j].apply(columns.middleRows(layout.first(j), layout.rows));
  }
}

NullHypothesis find_plain_null(const LinearisedFit& fit) {
  NullHypothesis null{.basis = TangentBasis(fit)};
  null.residual = null.basis.remove_from(fit.residual);
  return null;
}

NullHypothesis find_null(const LinearisedFit& fit, std::vector<Whitener> whiteners) {
  NullHypothesis null = find_plain_null(fit);
  null.whiteners = std::move(whiteners);
  whiten_null(null);
  return null;
}

NullHypothesis find_null(const LinearisedFit& fit) {
  NullHypothesis null = find_plain_null(fit);
  const Columns basis = null.basis.columns();
  const NoiseModels noise = fit_noise_models(fit.layout, null.residual);
  null.best = maximise(fit.layout, basis, null.residual, {noise, forget_colour(noise)});
  std::vector<int> orders;
  for (const NoiseModel& model : null.best.noise) {
    null.whiteners.emplace_back(model, fit.layout.runs);
    orders.push_back(model.order());
  }
  whiten_null(null);
  null.test = std::make_shared<const NoiseTest>(null.basis, std::move(orders));
  return null;
}

double predict_drop(const NullHypothesis& null, const Columns& added) {
  const RowLayout& layout = null.fit().layout;
  const VectorXd left =
      subtract(layout, null.residual, added, multiply_transposed(layout, added, null.residual));
  return 1.0 - total_rmse(layout, left) / total_rmse(layout, null.fit().residual);
}

}  // namespace sepcal::diagnosis
