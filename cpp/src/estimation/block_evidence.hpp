// SPDX-License-Identifier: BSD-3-Clause
// Whether a noise model is right, asked of the residual: in each block b of the record the score is
//   g_b = J_b'(e - J d)_b,   d = H^-1 J'e,
// and a noise of covariance S says how much it varies,
//   C_b = J_b'SJ_b - J_b'SJ H^-1 H_b - H_b H^-1 J'SJ_b + H_b H^-1 J'SJ H^-1 H_b,   H_b = J_b'J_b.
// Both give a delete-a-block jackknife, what blocks show and what the noise says they should, noise
// slower than a block included: the model takes that into account on its side as well.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "estimation/residual_colour.hpp"

namespace sepcal::estimation {

struct BlockEvidence {
  /// k: a parameter's block error over that which the noise says; NaN where a block or two
  /// determine it.
  Eigen::VectorXd shown = {};
  Eigen::VectorXd freedom = {};  // k degrees of freedom of its square, were the noise white
  double minus_two_log_likelihood = 0.0;  // of the scores, each block's by itself

  /// The geometric mean of what is shown; 1 of nothing.
  double mean() const;

  /// How many times the noise's error of parameter k is the nearest to it that the blocks don't
  /// refute, at 5 % on either side; 1 where they say nothing.
  double allowed(Eigen::Index k) const;
};

/// What is summed of each output, J over its deviation.
class BlockScores {
 public:
  BlockScores(Eigen::Index blocks, Eigen::Index columns);

  /// `J` (rows x k), the residual `e` and the deviation of a score's rows; without a noise they are
  /// white of that deviation.
  void add(const Eigen::MatrixXd& J, const Eigen::VectorXd& e,
           const std::optional<OutputNoise>& noise, double deviation,
           const std::vector<Segment>& runs);
  void add(const BlockScores& other);

  /// J'SJ: the covariance of the whole score.
  const Eigen::MatrixXd& score_covariance() const { return all_; }

  /// `prior` (k x k): its information. `K` (k x k, upper): J times K are the columns of the
  /// parameters that are asked for.
  BlockEvidence weigh(const Eigen::MatrixXd& prior, const Eigen::MatrixXd& K) const;

 private:
  void add_rows(const Eigen::MatrixXd& J, const Eigen::VectorXd& e, const Eigen::MatrixXd& SJ,
                const std::vector<Eigen::MatrixXd>& own, const std::vector<Eigen::Index>& cuts);

  struct Block {
    Eigen::MatrixXd information;  // H_b
    Eigen::VectorXd score;        // J_b'e_b
    Eigen::MatrixXd own;          // J_b'SJ_b
    Eigen::MatrixXd with_all;     // J_b'SJ
  };
  std::vector<Block> blocks_;
  Eigen::MatrixXd all_;
};

}  // namespace sepcal::estimation
