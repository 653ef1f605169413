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
#include <vector>

namespace sepcal::estimation {

/// Rows of a residual that count as one: the largest of the outputs' (columns of e, over their
/// noise), each the variance of a mean of rows times their number over the variance of a row, for
/// means of 1, 2, 4, ... rows as long as there are 16 of them, across gaps: what is slow goes on
/// behind one. At least 1.
double find_memory(const Eigen::MatrixXd& e);

/// How many blocks to cut `rows` rows into; 0 where a variance can't be told from the few there
/// would be.
int choose_blocks(Eigen::Index rows, double memory);

/// The first row of each block, and behind them `rows`: blocks as long as each other, to a row.
std::vector<Eigen::Index> cut_blocks(Eigen::Index rows, int blocks);

struct BlockErrors {
  Eigen::MatrixXd covariance;  // k x k; NaN in the rows of parameters that few blocks determine
  Eigen::VectorXd freedom;     // k degrees of freedom, were the noise white
};

/// `tangents`: n_z of [J | r] over all rows, over their noise and, with a loss, times sqrt(w); k
/// columns and the residual. `R` (k x k, upper): the factor of all of J and of the prior.
BlockErrors find_block_errors(const std::vector<Eigen::MatrixXd>& tangents,
                              const Eigen::MatrixXd& R, const std::vector<Eigen::Index>& blocks);

}  // namespace sepcal::estimation
