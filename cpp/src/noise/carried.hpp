// SPDX-License-Identifier: BSD-3-Clause
// What a noise of covariance S makes of columns X: S X, and what stretches of rows have of X' S X
// by themselves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "noise/gauss_markov_noise.hpp"
#include "sepcal/noise_model.hpp"
#include "sepcal/record.hpp"

namespace sepcal::noise {

struct Carried {
  Eigen::MatrixXd whole;             // S X, rows x q
  std::vector<Eigen::MatrixXd> own;  // X_b' S X_b (q x q), X_b the rows of stretch b and zeros else
};

/// Rows that a run and a stretch have in common.
struct Piece {
  std::size_t stretch = 0;
  Eigen::Index first = 0;
  Eigen::Index rows = 0;
  Eigen::Index run_first = 0;
  Eigen::Index run_rows = 0;
};

/// Stretch b goes from row `cuts[b]` to before `cuts[b + 1]`; the runs follow each other.
std::vector<Piece> cut_runs(const std::vector<Segment>& runs,
                            const std::vector<Eigen::Index>& cuts);

/// X (rows x q) in gather_rows' layout; S is that of covariance_product().
Carried carry(const NoiseModel& model, const std::vector<Segment>& runs,
              const std::vector<Eigen::Index>& cuts, const Eigen::MatrixXd& X);
Carried carry(const GaussMarkovNoise& noise, const std::vector<Segment>& runs,
              const std::vector<Eigen::Index>& cuts, const Eigen::MatrixXd& X);

}  // namespace sepcal::noise
