// SPDX-License-Identifier: BSD-3-Clause
#include "many/many_objective.hpp"

#include <algorithm>
#include <utility>

namespace sepcal::many {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void ManyObjective::weigh(const VectorXd& weights) {
  weights_ = weights;
  combine_blocks();
}

void ManyObjective::set_prior(const estimation::Prior& prior) {
  prior_ = prior;
  combine_blocks();
}

void ManyObjective::hold(std::vector<estimation::Prior> loose) {
  loose_ = std::move(loose);
  combine_blocks();
}

bool ManyObjective::linearise(const VectorXd& x) {
  if (at_.size() != x.size() || at_ != x) {
    std::vector<FlightPoint> points;
    for (Index i = 0; i < layout_.flights; ++i) points.push_back({flight(i), layout_.point(x, i)});
    factors_ = source_.linearise(points);
    at_ = x;
    ++passes_;
    combine_blocks();
  }
  return std::ranges::all_of(blocks_,
                             [](const TriangularFactor& block) { return block.all_finite(); });
}

std::vector<TriangularFactor> ManyObjective::flight_blocks(const VectorXd& weights) const {
  estimation::Prior own = prior_;
  own.weight.tail(layout_.shared).setZero();
  std::vector<TriangularFactor> blocks;
  for (std::size_t i = 0; i < factors_.size(); ++i) {
    blocks.push_back(combine(factors_[i], weights));
    if (own.weight.isZero(0.0)) continue;
    own.join(blocks.back(), layout_.point(at_, static_cast<Index>(i)));
  }
  return blocks;
}

TriangularFactor ManyObjective::shared_prior() const {
  TriangularFactor factor(static_cast<int>(layout_.shared + 1));
  prior_.tail(layout_.shared).join(factor, at_.tail(layout_.shared));
  return factor;
}

void ManyObjective::combine_blocks() {
  blocks_ = flight_blocks();
  if (blocks_.empty()) return;
  estimation::Prior shared = prior_;
  shared.weight.head(layout_.own).setZero();
  if (!shared.weight.isZero(0.0)) shared.join(blocks_.front(), layout_.point(at_, 0));
  for (std::size_t i = 0; i < loose_.size(); ++i) {
    loose_[i].join(blocks_[i], layout_.point(at_, static_cast<Index>(i)));
  }
}

VectorXd ManyObjective::squares(Index i) const {
  const std::vector<TriangularFactor>& factors = factors_[static_cast<std::size_t>(i)];
  VectorXd sums(static_cast<Index>(factors.size()));
  for (std::size_t j = 0; j < factors.size(); ++j) {
    const MatrixXd& T = factors[j].matrix();
    sums[static_cast<Index>(j)] = T.col(T.cols() - 1).squaredNorm();
  }
  return sums;
}

double ManyObjective::square() const {
  double sum = 0.0;
  for (const TriangularFactor& block : blocks_) {
    sum += block.matrix().col(block.columns() - 1).squaredNorm();
  }
  return sum;
}

}  // namespace sepcal::many
