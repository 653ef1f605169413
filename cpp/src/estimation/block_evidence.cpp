// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/block_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "estimation/block_errors.hpp"
#include "estimation/summed_rows.hpp"
#include "noise/carried.hpp"
#include "numerics/decompositions.hpp"
#include "numerics/tails.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// -2 ln L of a score g with covariance C, in the directions in which white noise moves it.
double score_likelihood(const VectorXd& g, const MatrixXd& C, const MatrixXd& white) {
  constexpr double least = 1e-8;  // of the largest variance
  const Eigen::SelfAdjointEigenSolver<MatrixXd> parts(white);
  const VectorXd& variances = parts.eigenvalues();
  constexpr double rounding =
      1e-12;  // a block that has all or nothing of every parameter shows none
  if (!(variances.maxCoeff() > rounding)) return 0.0;
  const double floor = least * variances.maxCoeff();
  const Index seen = (variances.array() > floor).count();
  const MatrixXd directions = parts.eigenvectors().rightCols(seen);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> own(
      MatrixXd(directions.transpose() * C * directions));
  const VectorXd spread = own.eigenvalues().cwiseMax(least * own.eigenvalues().maxCoeff());
  const VectorXd turned = own.eigenvectors().transpose() * (directions.transpose() * g);
  return spread.array().log().sum() + turned.cwiseAbs2().cwiseQuotient(spread).sum();
}

}  // namespace

double BlockEvidence::mean() const {
  double sum = 0.0;
  Index count = 0;
  for (const double ratio : shown) {
    if (!(std::isfinite(ratio) && ratio > 0.0)) continue;
    sum += std::log(ratio);
    ++count;
  }
  return count > 0 ? std::exp(sum / static_cast<double>(count)) : 1.0;
}

double BlockEvidence::allowed(Index k) const {
  constexpr double either_side = 0.05;
  if (shown.size() == 0 || !std::isfinite(shown[k])) return 1.0;
  const double n = freedom[k];
  const double least = shown[k] * std::sqrt(n / numerics::chi_squared_point(either_side, n));
  const double most = shown[k] * std::sqrt(n / numerics::chi_squared_point(1.0 - either_side, n));
  return std::clamp(1.0, least, most);
}

BlockScores::BlockScores(Index blocks, Index columns)
    : blocks_(static_cast<std::size_t>(blocks),
              {MatrixXd::Zero(columns, columns), VectorXd::Zero(columns),
               MatrixXd::Zero(columns, columns), MatrixXd::Zero(columns, columns)}),
      all_(MatrixXd::Zero(columns, columns)) {}

void BlockScores::add(const MatrixXd& J, const VectorXd& e, const std::optional<OutputNoise>& noise,
                      double deviation, const std::vector<Segment>& runs) {
  if (noise && noise->stride > 1) {
    const SummedRows sums(J, runs, noise->stride);
    const SummedRows left(e, runs, noise->stride);
    add(sums.columns, left.columns, OutputNoise{noise->model}, deviation, sums.runs);
    return;
  }
  const std::vector<Index> cuts = cut_blocks(J.rows(), static_cast<int>(blocks_.size()));
  if (!noise) {
    std::vector<MatrixXd> own;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const auto rows = J.middleRows(cuts[b], cuts[b + 1] - cuts[b]);
      own.emplace_back(rows.transpose() * rows);
    }
    add_rows(J, e, J, own, cuts);
    return;
  }
  const noise::Carried carried = std::visit(
      [&](auto model) {
        model.sigma /= deviation;
        return noise::carry(model, runs, cuts, J);
      },
      noise->model);
  add_rows(J, e, carried.whole, carried.own, cuts);
}

void BlockScores::add_rows(const MatrixXd& J, const VectorXd& e, const MatrixXd& SJ,
                           const std::vector<MatrixXd>& own, const std::vector<Index>& cuts) {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Index rows = cuts[b + 1] - cuts[b];
    const auto J_b = J.middleRows(cuts[b], rows);
    Block& block = blocks_[b];
    block.information += J_b.transpose() * J_b;
    block.score += J_b.transpose() * e.segment(cuts[b], rows);
    block.own += own[b];
    const MatrixXd with_all = J_b.transpose() * SJ.middleRows(cuts[b], rows);
    block.with_all += with_all;
    all_ += with_all;
  }
}

void BlockScores::add(const BlockScores& other) {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    blocks_[b].information += other.blocks_[b].information;
    blocks_[b].score += other.blocks_[b].score;
    blocks_[b].own += other.blocks_[b].own;
    blocks_[b].with_all += other.blocks_[b].with_all;
  }
  all_ += other.all_;
}

BlockEvidence BlockScores::weigh(const MatrixXd& prior, const MatrixXd& K) const {
  const Index k = all_.cols();
  MatrixXd information = prior;
  for (const Block& block : blocks_) information += block.information;
  const Eigen::LLT<MatrixXd> root(information);
  if (root.info() != Eigen::Success) return {};
  // In coordinates in which all the information is I.
  const MatrixXd inverse = root.matrixU().solve(MatrixXd(MatrixXd::Identity(k, k)));
  const auto turn = [&](const MatrixXd& square) -> MatrixXd {
    return inverse.transpose() * square * inverse;
  };
  const MatrixXd all = turn(all_);
  const MatrixXd wanted =  // k columns: a parameter of those coordinates
      (K.triangularView<Eigen::Upper>().solve(inverse)).transpose();
  VectorXd shown = VectorXd::Zero(k);
  VectorXd said = VectorXd::Zero(k);
  BlockEvidence evidence;
  std::vector<BlockShare> shares;
  for (const Block& block : blocks_) {
    shares.push_back(make_block_share(turn(block.information), inverse.transpose() * block.score));
    const BlockShare& share = shares.back();
    const MatrixXd taken = turn(block.with_all) * share.own;
    const MatrixXd C = turn(block.own) - taken - taken.transpose() + share.own * all * share.own;
    const MatrixXd of_score = share.others.solve(wanted);
    shown += (of_score.transpose() * share.gradient).cwiseAbs2();
    said += of_score.cwiseProduct(C * of_score).colwise().sum().transpose();
    evidence.minus_two_log_likelihood +=
        score_likelihood(share.gradient, C, share.own - share.own * share.own);
  }
  evidence.freedom = degrees_of_freedom(shares, wanted);
  evidence.shown = shown.cwiseQuotient(said).cwiseSqrt();
  for (Index i = 0; i < k; ++i) {
    if (evidence.freedom[i] >= least_freedom) continue;
    evidence.shown[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return evidence;
}

}  // namespace sepcal::estimation
