// SPDX-License-Identifier: BSD-3-Clause
#include "many/arrowhead.hpp"

#include <cmath>

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

auto columns_of(const TriangularFactor& block) {
  return block.matrix().leftCols(block.columns() - 1);
}

auto right_side(const TriangularFactor& block) { return block.matrix().col(block.columns() - 1); }

/// Which of a flight's [own | shared] columns are free.
struct FreeColumns {
  std::vector<Index> places;  // own ones first
  Index own = 0;
};

FreeColumns free_columns(const Layout& layout, const std::vector<bool>& free, Index flight) {
  FreeColumns columns;
  for (Index k = 0; k < layout.own + layout.shared; ++k) {
    if (!free[static_cast<std::size_t>(layout.place(flight, k))]) continue;
    columns.places.push_back(k);
    if (k < layout.own) ++columns.own;
  }
  return columns;
}

}  // namespace

Share eliminate_own(MatrixXd rows, Index n_own) {
  TriangularFactor factor(static_cast<int>(rows.cols()));
  factor.absorb(rows);
  const MatrixXd& T = factor.matrix();
  const Index below = T.cols() - n_own;
  Share share{T.topLeftCorner(n_own, n_own), T.block(0, n_own, n_own, below - 1),
              T.col(T.cols() - 1).head(n_own), TriangularFactor(static_cast<int>(below))};
  const MatrixXd unseen = solve_triangular(share.own, VectorXd::Zero(n_own)).unseen.transpose();
  MatrixXd rest(below + unseen.rows(), below);
  rest.topRows(below) = T.bottomRightCorner(below, below);
  rest.bottomRows(unseen.rows()) = unseen * T.topRightCorner(n_own, below);
  share.shared.absorb(rest);
  return share;
}

TriangularFactor merge_shared(const std::vector<Share>& shares) {
  TriangularFactor merged(shares.front().shared.columns());
  for (const Share& share : shares) merged.merge(share.shared);
  return merged;
}

MatrixXd shared_factor(const std::vector<Share>& shares, MatrixXd known) {
  TriangularFactor all = merge_shared(shares);
  all.absorb(known);
  const Index n_shared = all.columns() - 1;
  return all.matrix().topLeftCorner(n_shared, n_shared);
}

MatrixXd beside_others(const Share& share, const MatrixXd& joint) {
  const Index n_own = share.own.cols();
  MatrixXd K = MatrixXd::Zero(n_own + joint.cols(), n_own + joint.cols());
  K.topLeftCorner(n_own, n_own) = share.own;
  K.topRightCorner(n_own, joint.cols()) = share.cross;
  K.bottomRightCorner(joint.cols(), joint.cols()) = joint;
  return K;
}

VectorXd Arrowhead::lengths() const {
  VectorXd squares = VectorXd::Zero(layout_.size());
  for (Index i = 0; i < layout_.flights; ++i) {
    const VectorXd square =
        columns_of(blocks_[static_cast<std::size_t>(i)]).colwise().squaredNorm();
    layout_.own_of(squares, i) = square.head(layout_.own);
    squares.tail(layout_.shared) += square.tail(layout_.shared);
  }
  return squares.cwiseSqrt();
}

VectorXd Arrowhead::pull(const VectorXd& x) const {
  VectorXd pull = VectorXd::Zero(layout_.size());
  for (Index i = 0; i < layout_.flights; ++i) {
    const TriangularFactor& block = blocks_[static_cast<std::size_t>(i)];
    const VectorXd left = right_side(block) - columns_of(block) * layout_.point(x, i);
    const VectorXd part = columns_of(block).transpose() * left;
    layout_.own_of(pull, i) = part.head(layout_.own);
    pull.tail(layout_.shared) += part.tail(layout_.shared);
  }
  return pull;
}

VectorXd Arrowhead::minimise_over(const std::vector<Index>& free, VectorXd x) const {
  std::vector<bool> is_free(static_cast<std::size_t>(layout_.size()));
  for (const Index k : free) is_free[static_cast<std::size_t>(k)] = true;
  x(free).setZero();
  std::vector<FreeColumns> columns;
  std::vector<Share> shares;
  for (Index i = 0; i < layout_.flights; ++i) {
    const TriangularFactor& block = blocks_[static_cast<std::size_t>(i)];
    columns.push_back(free_columns(layout_, is_free, i));
    const auto count = static_cast<Index>(columns.back().places.size());
    MatrixXd rows(block.columns(), count + 1);
    rows.leftCols(count) = columns_of(block)(Eigen::all, columns.back().places);
    rows.col(count) = right_side(block) - columns_of(block) * layout_.point(x, i);
    shares.push_back(eliminate_own(std::move(rows), columns.back().own));
  }
  const MatrixXd T = merge_shared(shares).matrix();
  const Index free_shared = T.cols() - 1;
  const VectorXd shared = solve_triangular(T.topLeftCorner(free_shared, free_shared),
                                           T.col(free_shared).head(free_shared))
                              .x;
  for (Index i = 0; i < layout_.flights; ++i) {
    const Share& share = shares[static_cast<std::size_t>(i)];
    const VectorXd own = solve_triangular(share.own, share.rest - share.cross * shared).x;
    const FreeColumns& at = columns[static_cast<std::size_t>(i)];
    for (Index k = 0; k < own.size(); ++k) {
      layout_.own_of(x, i)[at.places[static_cast<std::size_t>(k)]] = own[k];
    }
    if (i > 0) continue;
    for (Index k = 0; k < free_shared; ++k) {
      const Index place = at.places[static_cast<std::size_t>(at.own + k)] - layout_.own;
      x.tail(layout_.shared)[place] = shared[k];
    }
  }
  return x;
}

double Arrowhead::length_of(const VectorXd& x) const {
  double square = 0.0;
  for (Index i = 0; i < layout_.flights; ++i) {
    square +=
        (columns_of(blocks_[static_cast<std::size_t>(i)]) * layout_.point(x, i)).squaredNorm();
  }
  return std::sqrt(square);
}

double Arrowhead::residual() const {
  double square = 0.0;
  for (const TriangularFactor& block : blocks_) square += right_side(block).squaredNorm();
  return std::sqrt(square);
}

}  // namespace sepcal::many
