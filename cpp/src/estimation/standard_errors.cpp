// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/standard_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimation/block_errors.hpp"
#include "estimation/error_sentences.hpp"
#include "model/loss.hpp"
#include "numerics/symmetric.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The residual and its tangent as the errors take them: over the noise that was judged and, with a
/// loss, times sqrt(w).
class Weighted {
 public:
  Weighted(const Problem& problem, const model::Sweep& sweep, const StageTwo& two,
           const Covariances& covariances)
      : sweep_(sweep),
        two_(two),
        inverses_(covariances.judged.cwiseInverse()),
        columns_(covariances.inside) {
    const FitOptions& options = problem.options();
    if (options.loss != Loss::squares) {
      weight_ = [loss = model::RobustLoss(options.loss, options.loss_width), &two](
                    Index j, double r) { return std::sqrt(loss.weight(r / two.noise[j])); };
    }
    columns_.push_back(sweep.tables().n_1() + sweep.tables().n_2());
  }

  /// The rows of the residual that count as one.
  double memory() const {
    Memory memory(inverses_.size());
    sweep_.for_each_residual(xi1(), xi2(), [&](const MatrixXd& r) {
      MatrixXd e = r;
      for (Index j = 0; weight_ && j < r.cols(); ++j) {
        for (double& each : e.col(j)) each *= weight_(j, each);
      }
      memory.add(e * inverses_.asDiagonal());
    });
    return memory.rows();
  }

  /// The factor of each block's [J | r], of all outputs and the free parameters that no bound
  /// holds.
  std::vector<TriangularFactor> factors(const std::vector<Index>& cuts) const {
    std::vector<TriangularFactor> blocks;
    for (const auto& by_output : sweep_.stretch_factors(xi1(), xi2(), cuts, weight_)) {
      TriangularFactor& block = blocks.emplace_back(static_cast<int>(columns_.size()));
      for (std::size_t j = 0; j < by_output.size(); ++j) {
        MatrixXd rows =
            by_output[j].matrix()(Eigen::all, columns_) * inverses_[static_cast<Index>(j)];
        block.absorb(rows);
      }
    }
    return blocks;
  }

 private:
  VectorXd xi1() const { return two_.x.head(sweep_.tables().n_1()); }
  VectorXd xi2() const { return two_.x.tail(sweep_.tables().n_2()); }

  const model::Sweep& sweep_;
  const StageTwo& two_;
  VectorXd inverses_;  // n_z, of the noise
  std::vector<Index> columns_;
  model::Sweep::RowWeight weight_;  // sqrt(w), with a loss
};

/// The jackknife's covariance (k x k), with the prior's own share and, with a loss, the slopes of
/// psi.
MatrixXd block_covariance(const Problem& problem, const model::Sweep& sweep, const StageTwo& two,
                          const Covariances& covariances) {
  const auto k = static_cast<Index>(covariances.inside.size());
  const Weighted weighted(problem, sweep, two, covariances);
  const auto rows = static_cast<Index>(sweep.measurements().rows());
  const double memory = weighted.memory();
  const int blocks = std::isfinite(memory) ? choose_blocks(rows, memory) : 0;
  if (blocks == 0) {
    return MatrixXd::Constant(k, k, std::numeric_limits<double>::quiet_NaN());
  }
  const MatrixXd R = select_columns(covariances.tangent, covariances.inside);
  MatrixXd covariance = find_block_errors(weighted.factors(cut_blocks(rows, blocks)), R).covariance;
  for (const Prior& prior : problem.prior()) {
    const MatrixXd pulled = covariances.white * prior.weight(covariances.inside).asDiagonal();
    covariance += pulled * pulled.transpose();
  }
  if (problem.options().loss != Loss::squares) {
    const MatrixXd slopes = covariances.inverse_hessian * R.transpose() * R;
    covariance = numerics::symmetric_part(slopes * covariance * slopes.transpose());
  }
  return covariance;
}

/// The noise model's covariance, with each error as near to it as the blocks' evidence allows, and
/// the blocks' errors where these are more than `from` times as large: what a noise model can't say
/// makes its errors too small.
MatrixXd believe(const Covariances& covariances, const VectorXd& blocks, double from) {
  const MatrixXd& noise_model = covariances.noise_model;
  VectorXd scale(blocks.size());
  for (Index k = 0; k < blocks.size(); ++k) {
    scale[k] = covariances.evidence.allowed(k);
    const double ratio = blocks[k] / std::sqrt(noise_model(k, k));
    if (ratio > from) scale[k] = std::max(scale[k], ratio);
  }
  return noise_model.cwiseProduct(scale * scale.transpose());
}

}  // namespace

StandardErrors find_standard_errors(const Problem& problem, const model::Sweep& sweep,
                                    const SampledRows& sampled, const StageTwo& two,
                                    const Covariances& covariances) {
  const auto k = static_cast<Index>(covariances.inside.size());
  StandardErrors errors{
      .believed = covariances.noise_model,
      .blocks = MatrixXd::Constant(k, k, std::numeric_limits<double>::quiet_NaN()),
      .sentences = {}};
  const bool defined = k > 0 && covariances.noise_model.allFinite();
  if (!defined || !problem.options().coloured_errors) return errors;
  errors.blocks = block_covariance(problem, sweep, two, covariances);
  const VectorXd blocks = errors.blocks.diagonal().cwiseSqrt();
  errors.believed = believe(covariances, blocks, believed_from(covariances));
  std::vector<std::string> names;
  for (const Index at : covariances.inside) {
    names.push_back(problem.parameters()[static_cast<std::size_t>(at)].name);
  }
  errors.sentences = describe_errors(names, covariances, blocks, sweep);
  if (sampled.rows > 1.0) {
    errors.sentences.push_back(describe_sample(covariances, sweep, sampled.sweep));
  }
  return errors;
}

}  // namespace sepcal::estimation
