// SPDX-License-Identifier: BSD-3-Clause
// S_ij are the products i and j rows back, from all rows of a block, less those at its ends.
#include "noise/lagged_squares.hpp"

#include <algorithm>

#include "noise/autoregression.hpp"
#include "noise/autoregression_filter.hpp"
#include "numerics/tall_products.hpp"

namespace sepcal::noise {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

namespace {

/// Calls visit(i, j, place) for i <= j < count.
template <class Visit>
void for_each_pair(Index count, const Visit& visit) {
  std::size_t place = 0;
  for (Index i = 0; i < count; ++i) {
    for (Index j = i; j < count; ++j) visit(i, j, place++);
  }
}

/// sum of c_ij M_ij with M_ji = M_ij'.
void add_weighted(const MatrixXd& coefficients, const std::vector<MatrixXd>& upper, MatrixXd& sum) {
  for_each_pair(coefficients.rows(), [&](Index i, Index j, std::size_t place) {
    sum += coefficients(i, j) * upper[place];
    if (i != j) sum += coefficients(i, j) * upper[place].transpose();
  });
}

std::vector<MatrixXd> zeros(Index pairs_of, Index columns) {
  return std::vector<MatrixXd>(static_cast<std::size_t>(pairs_of * (pairs_of + 1) / 2),
                               MatrixXd::Zero(columns, columns));
}

}  // namespace

LaggedSquares::LaggedSquares(const Ref<const MatrixXd>& columns, const std::vector<Index>& blocks,
                             Index skipped, Index order)
    : order_(order),
      plain_(MatrixXd::Zero(columns.cols(), columns.cols())),
      left_(plain_),
      later_(zeros(order + 1, columns.cols())),
      earlier_(zeros(order, columns.cols())) {
  numerics::add_square(columns, plain_);
  std::vector<MatrixXd> lagged(static_cast<std::size_t>(order) + 1, left_);
  Index first = 0;
  for (const Index rows : blocks) {
    numerics::add_square(columns.middleRows(first, skipped), left_);
    const auto x = columns.middleRows(first + skipped, rows);
    first += skipped + rows;
    const auto product = [&](Index s, Index lag) { return x.row(s).transpose() * x.row(s - lag); };
    if (rows < order) {
      short_.emplace_back(x);
      continue;
    }
    for_each_pair(order, [&](Index s, Index t, std::size_t place) {
      earlier_[place] += x.row(s).transpose() * x.row(t);
    });
    for (Index lag = 0; lag <= order; ++lag) {
      numerics::add_transposed_product(x.bottomRows(rows - lag), x.topRows(rows - lag),
                                       lagged[static_cast<std::size_t>(lag)]);
    }
    for_each_pair(order + 1, [&](Index i, Index j, std::size_t place) {
      const Index lag = j - i;
      for (Index s = lag; s < order - i; ++s) later_[place] -= product(s, lag);
      for (Index s = rows - i; s < rows; ++s) later_[place] -= product(s, lag);
    });
  }
  for_each_pair(order + 1, [&](Index i, Index j, std::size_t place) {
    later_[place] += lagged[static_cast<std::size_t>(j - i)];
  });
}

MatrixXd LaggedSquares::whitened(const VectorXd& partial) const {
  VectorXd a(order_ + 1);
  a << 1.0, -phi_from_partial(partial);
  MatrixXd early = MatrixXd::Identity(order_, order_);
  for (auto column : early.colwise()) whiten_autoregression(partial, column);
  MatrixXd sum = left_;
  add_weighted(a * a.transpose(), later_, sum);
  add_weighted(early.transpose() * early, earlier_, sum);
  for (MatrixXd rows : short_) {
    for (auto column : rows.colwise()) whiten_autoregression(partial, column);
    numerics::add_square(rows, sum);
  }
  return sum;
}

bool LaggedSquares::is_sound(const MatrixXd& whitened) const {
  constexpr double kept = 1e-5;
  return (whitened.diagonal().array() >= kept * plain_.diagonal().array()).all();
}

}  // namespace sepcal::noise
