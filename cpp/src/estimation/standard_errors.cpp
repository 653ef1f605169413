// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/standard_errors.hpp"

#include <cmath>
#include <limits>

#include "estimation/block_errors.hpp"
#include "estimation/error_sentences.hpp"
#include "model/loss.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// [J | r] of every output over the noise that was judged; with a loss, times sqrt(w).
std::vector<MatrixXd> weighted_tangents(const Problem& problem, const model::Sweep& sweep,
                                        const StageTwo& two, const Covariances& covariances) {
  const Index n_1 = sweep.tables().n_1();
  const Index n_2 = sweep.tables().n_2();
  std::vector<Index> columns = covariances.inside;
  columns.push_back(n_1 + n_2);
  const FitOptions& options = problem.options();
  std::vector<MatrixXd> tangents = sweep.tangent_rows(two.x.head(n_1), two.x.tail(n_2));
  for (std::size_t j = 0; j < tangents.size(); ++j) {
    MatrixXd rows = tangents[j](Eigen::all, columns);
    if (options.loss != Loss::squares) {
      const model::RobustLoss loss(options.loss, options.loss_width);
      const double noise = two.noise[static_cast<Index>(j)];
      for (auto row : rows.rowwise()) {
        row *= std::sqrt(loss.weight(row[row.size() - 1] / noise));
      }
    }
    tangents[j] = rows / covariances.judged[static_cast<Index>(j)];
  }
  return tangents;
}

MatrixXd residuals_of(const std::vector<MatrixXd>& tangents) {
  MatrixXd residuals(tangents.front().rows(), static_cast<Index>(tangents.size()));
  for (std::size_t j = 0; j < tangents.size(); ++j) {
    residuals.col(static_cast<Index>(j)) = tangents[j].rightCols<1>();
  }
  return residuals;
}

/// The jackknife's covariance (k x k), with the prior's own share and, with a loss, the slopes of
/// psi.
MatrixXd block_covariance(const Problem& problem, const model::Sweep& sweep, const StageTwo& two,
                          const Covariances& covariances) {
  const auto k = static_cast<Index>(covariances.inside.size());
  const std::vector<MatrixXd> tangents = weighted_tangents(problem, sweep, two, covariances);
  const MatrixXd e = residuals_of(tangents);
  const int blocks = choose_blocks(e.rows(), find_memory(e));
  if (blocks == 0 || !e.allFinite()) {
    return MatrixXd::Constant(k, k, std::numeric_limits<double>::quiet_NaN());
  }
  const MatrixXd R = select_columns(covariances.tangent, covariances.inside);
  MatrixXd covariance = find_block_errors(tangents, R, cut_blocks(e.rows(), blocks)).covariance;
  for (const Prior& prior : problem.prior()) {
    const MatrixXd pulled = covariances.white * prior.weight(covariances.inside).asDiagonal();
    covariance += pulled * pulled.transpose();
  }
  if (problem.options().loss != Loss::squares) {
    const MatrixXd slopes = covariances.inverse_hessian * R.transpose() * R;
    covariance = slopes * covariance * slopes.transpose();
  }
  return covariance;
}

/// The noise model's covariance, but with the blocks' errors where these are far larger: what a
/// noise model can't say makes its errors too small; blocks that don't see slow noise make theirs
/// too small.
MatrixXd believe(const MatrixXd& noise_model, const VectorXd& blocks) {
  VectorXd scale = VectorXd::Ones(blocks.size());
  for (Index k = 0; k < blocks.size(); ++k) {
    const double ratio = blocks[k] / std::sqrt(noise_model(k, k));
    if (ratio > far_apart) scale[k] = ratio;
  }
  return scale.asDiagonal() * noise_model * scale.asDiagonal();
}

}  // namespace

StandardErrors find_standard_errors(const Problem& problem, const model::Sweep& sweep,
                                    const StageTwo& two, const Covariances& covariances) {
  const auto k = static_cast<Index>(covariances.inside.size());
  StandardErrors errors{
      .believed = covariances.noise_model,
      .blocks = MatrixXd::Constant(k, k, std::numeric_limits<double>::quiet_NaN()),
      .sentences = {}};
  const bool defined = k > 0 && covariances.noise_model.allFinite();
  if (!defined || !problem.options().coloured_errors) return errors;
  errors.blocks = block_covariance(problem, sweep, two, covariances);
  const VectorXd blocks = errors.blocks.diagonal().cwiseSqrt();
  errors.believed = believe(covariances.noise_model, blocks);
  std::vector<std::string> names;
  for (const Index at : covariances.inside) {
    names.push_back(problem.parameters()[static_cast<std::size_t>(at)].name);
  }
  errors.sentences = describe_errors(names, covariances, blocks, sweep);
  return errors;
}

}  // namespace sepcal::estimation
