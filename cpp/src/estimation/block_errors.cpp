// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/block_errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "numerics/symmetric.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

/// The factor of a block's [J | r] over R, all information.
BlockShare share_of(const TriangularFactor& block, const MatrixXd& R) {
  const Index k = R.cols();
  MatrixXd rows = block.matrix();
  Ref<MatrixXd> J = rows.leftCols(k);
  R.triangularView<Eigen::Upper>().solveInPlace<Eigen::OnTheRight>(J);
  return make_block_share(J.transpose() * J, J.transpose() * rows.col(k));
}

}  // namespace

BlockShare make_block_share(MatrixXd own, VectorXd gradient) {
  BlockShare share{.own = std::move(own), .gradient = std::move(gradient), .others = {}};
  const Index k = share.own.cols();
  // The least information that the others may be said to have; more where rounding asks for it.
  double least = 1e-12;
  do {
    share.others.compute((1.0 + least) * MatrixXd::Identity(k, k) - share.own);
    least *= 10.0;
  } while (share.others.info() != Eigen::Success && least < 1.0);
  return share;
}

VectorXd degrees_of_freedom(const std::vector<BlockShare>& shares, const MatrixXd& l) {
  const auto blocks = static_cast<Index>(shares.size());
  const Index k = l.cols();
  std::vector<MatrixXd> taken(shares.size());  // J_b'y_b
  MatrixXd variances(blocks, k);  // of y_b'r: |y_b|^2 - |J_b'y_b|^2, without its rounding
  for (std::size_t b = 0; b < shares.size(); ++b) {
    taken[b] = shares[b].own * shares[b].others.solve(l);
    variances.row(static_cast<Index>(b)) = l.cwiseProduct(taken[b]).colwise().sum();
  }
  VectorXd freedom(k);
  MatrixXd own(k, blocks);
  for (Index i = 0; i < k; ++i) {
    for (Index b = 0; b < blocks; ++b) own.col(b) = taken[static_cast<std::size_t>(b)].col(i);
    MatrixXd P = -own.transpose() * own;
    P.diagonal() = variances.col(i);
    freedom[i] = P.trace() * P.trace() / P.squaredNorm();
  }
  return freedom;
}

Memory::Memory(Index outputs) : outputs_(outputs) {}

void Memory::add(const MatrixXd& e) {
  MatrixXd means = e;
  for (std::size_t length = 0; means.rows() > 0; ++length) {
    if (length == lengths_.size())
      lengths_.push_back({.squares = VectorXd::Zero(outputs_), .waiting = MatrixXd(0, outputs_)});
    means = lengths_[length].join(means);
  }
}

MatrixXd Memory::Length::join(const MatrixXd& means) {
  squares += means.colwise().squaredNorm().transpose();
  MatrixXd all(waiting.rows() + means.rows(), means.cols());
  all << waiting, means;
  count += means.rows();
  const Index pairs = all.rows() / 2;
  waiting = all.bottomRows(all.rows() - 2 * pairs);
  return 0.5 *
         (all(Eigen::seqN(0, pairs, 2), Eigen::all) + all(Eigen::seqN(1, pairs, 2), Eigen::all));
}

double Memory::rows() const {
  constexpr Index fewest = 16;
  double memory = 1.0;
  for (std::size_t length = 0; length < lengths_.size(); ++length) {
    const Length& own = lengths_[length];
    if (!own.squares.allFinite()) return std::numeric_limits<double>::quiet_NaN();
    if (own.count < fewest) break;
    const double rows = std::exp2(static_cast<double>(length));
    for (Index j = 0; j < outputs_; ++j) {
      const double variance = lengths_[0].squares[j] / static_cast<double>(lengths_[0].count);
      if (!(variance > 0.0)) continue;
      memory = std::max(memory, rows * own.squares[j] / static_cast<double>(own.count) / variance);
    }
  }
  return memory;
}

int choose_blocks(Index rows, double memory) {
  constexpr double most = 40.0;
  constexpr double fewest = 8.0;
  constexpr double memories = 3.0;  // a block is as long as so many
  const double count = static_cast<double>(rows) / (memories * memory);
  const double possible = std::min(most, static_cast<double>(rows) / 2.0);
  if (possible < fewest) return 0;
  return static_cast<int>(std::clamp(count, fewest, possible));
}

std::vector<Index> cut_blocks(Index rows, int blocks) {
  std::vector<Index> first;
  for (Index b = 0; b <= blocks; ++b) first.push_back(b * rows / blocks);
  return first;
}

BlockErrors find_block_errors(const std::vector<TriangularFactor>& blocks, const MatrixXd& R) {
  const Index k = R.cols();
  std::vector<BlockShare> shares;
  MatrixXd steps = MatrixXd::Zero(k, k);
  for (const TriangularFactor& block : blocks) {
    shares.push_back(share_of(block, R));
    const VectorXd step = shares.back().step();
    steps += step * step.transpose();
  }
  const auto count = static_cast<double>(shares.size());
  const MatrixXd inverse =
      R.triangularView<Eigen::Upper>().solve(MatrixXd(MatrixXd::Identity(k, k)));
  BlockErrors errors{.covariance = numerics::symmetric_part(
                         inverse * ((count - 1.0) / count * steps) * inverse.transpose()),
                     .freedom = degrees_of_freedom(shares, inverse.transpose())};
  for (Index i = 0; i < k; ++i) {
    if (errors.freedom[i] >= least_freedom) continue;
    errors.covariance.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    errors.covariance.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return errors;
}

}  // namespace sepcal::estimation
