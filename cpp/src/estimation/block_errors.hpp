// SPDX-License-Identifier: BSD-3-Clause
// Block errors: how much the estimates move when a stretch of the record is left out. No noise
// model takes part. The record is cut into B blocks longer than its residual remembers, and each is
// left out in turn by one Gauss-Newton step,
//   x_b - x = -(H - J_b'J_b)^-1 J_b'r_b,    Cov = (B - 1) / B sum_b (x_b - x)(x_b - x)':
// the delete-a-block jackknife (Efron & Tibshirani, An Introduction to the Bootstrap, Ch. 11;
// Busing et al., Statistics and Computing 9, 1999), which is CR3 of Bell & McCaffrey (Survey
// Methodology 28, 2002), whose degrees of freedom say what it is worth.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "numerics/decompositions.hpp"
#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::estimation {

/// Rows of a residual that count as one: the largest of the outputs', each the variance of a mean
/// of rows times their number over the variance of a row, for means of 1, 2, 4, ... rows as long as
/// there are 16 of them, across gaps: what is slow goes on behind one. At least 1.
class Memory {
 public:
  explicit Memory(Eigen::Index outputs);

  /// Rows that follow (rows x outputs), over their noise.
  void add(const Eigen::MatrixXd& e);

  /// Of all rows that were added; NaN where one of them is not finite.
  double rows() const;

 private:
  /// Means of so many rows that follow each other.
  struct Length {
    Eigen::VectorXd squares = {};  // outputs, their sum
    Eigen::MatrixXd waiting = {};  // a mean that the next one joins (1 x outputs), or none
    Eigen::Index count = 0;

    /// The means of twice the length that come of it.
    Eigen::MatrixXd join(const Eigen::MatrixXd& means);
  };

  Eigen::Index outputs_;
  std::vector<Length> lengths_;  // 1, 2, 4, ... rows
};

/// How many blocks to cut `rows` rows into; 0 where a variance can't be told from the few there
/// would be.
int choose_blocks(Eigen::Index rows, double memory);

/// The first row of each block, and behind them `rows`: blocks as long as each other, to a row.
std::vector<Eigen::Index> cut_blocks(Eigen::Index rows, int blocks);

/// A block in coordinates in which the information of all rows and the prior is I: its own, and the
/// factor of what the others have.
struct BlockShare {
  Eigen::MatrixXd own;       // k x k, J_b'J_b
  Eigen::VectorXd gradient;  // k, J_b'r_b
  Eigen::LLT<Eigen::MatrixXd> others;

  /// The step of the estimates when the block is left out, but for its sign.
  Eigen::VectorXd step() const { return others.solve(gradient); }
};

BlockShare make_block_share(Eigen::MatrixXd own, Eigen::VectorXd gradient);

/// Satterthwaite's degrees of freedom of sum_b (y_b'r)^2, r the residual of white noise: y_b, in
/// the rows of block b, takes the step of a combination when b is left out. Of each combination
/// that is a column of `l` (k x k).
Eigen::VectorXd degrees_of_freedom(const std::vector<BlockShare>& shares, const Eigen::MatrixXd& l);

/// Of blocks, below which a variance is not told: known to 70 %.
inline constexpr double least_freedom = 4.0;

struct BlockErrors {
  Eigen::MatrixXd covariance;  // k x k; NaN in the rows of parameters that few blocks determine
  Eigen::VectorXd freedom;     // k degrees of freedom, were the noise white
};

/// `blocks`: the factor of each block's [J | r] over their noise and, with a loss, times sqrt(w),
/// of all outputs; k columns and the residual. `R` (k x k, upper): the factor of all of J and of
/// the prior.
BlockErrors find_block_errors(const std::vector<TriangularFactor>& blocks,
                              const Eigen::MatrixXd& R);

}  // namespace sepcal::estimation
