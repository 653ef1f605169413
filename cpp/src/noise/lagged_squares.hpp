// SPDX-License-Identifier: BSD-3-Clause
// X'W'WX for the W of any autoregression, by products of X's columns some rows apart: rows are gone
// through once for all. Past the first p rows of a block (W x)_t = sum_i a_i x_{t-i}, a = (1,
// -phi),
//   sum_t (Wx)_t (Wx)_t' = sum_{i,j} a_i a_j S_ij,   S_ij = sum_{t>=p} x_{t-i} x_{t-j}'.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sepcal::noise {

class LaggedSquares {
 public:
  /// Columns whose rows are those of blocks, one after another, each behind `skipped` rows that the
  /// autoregression of this order leaves as they are.
  LaggedSquares(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                const std::vector<Eigen::Index>& blocks, Eigen::Index skipped, Eigen::Index order);

  /// X'W'WX (columns x columns) for as many partial autocorrelations as the order, of innovations
  /// with variance 1.
  Eigen::MatrixXd whitened(const Eigen::VectorXd& partial) const;

  /// Whether a result has lost less than five digits to rounding: what is predicted but for that
  /// part has to be whitened row by row.
  bool is_sound(const Eigen::MatrixXd& whitened) const;

 private:
  Eigen::Index order_;
  Eigen::MatrixXd plain_;                 // X'X
  Eigen::MatrixXd left_;                  // of the rows left as they are
  std::vector<Eigen::MatrixXd> later_;    // S_ij, i <= j, row by row of the upper triangle
  std::vector<Eigen::MatrixXd> earlier_;  // of rows s <= t < p of the blocks, likewise
  std::vector<Eigen::MatrixXd> short_;    // the rows of blocks that have fewer than p
};

}  // namespace sepcal::noise
