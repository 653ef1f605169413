// SPDX-License-Identifier: BSD-3-Clause
// W with W'W = Gamma^-1 for the covariance Gamma of phi(B) (1 - B)^delta x = w, -1 <= delta < 0.5.
// For p = 0 the exact finite predictor is a convolution between two diagonals: with
// g_s = G(s+1-delta) / s! and v_t its variance,
//   w_t = sum_{s<=t} pi_{t-s} g_s x_s / (g_t sqrt v_t)     (from Hosking's phi_{t,j}, 1981).
#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "noise/fractional_difference.hpp"

namespace sepcal::noise {

/// With an AR, the rows u = phi(B) x past the first p are whitened like that, and the first p given
/// those (their regression on later rows is cut after 1024). Const and thread-safe.
class ArfimaFactor {
 public:
  /// For blocks of the given numbers of rows (zeros are ignored); phi is stationary. Where phi is
  /// so near its border that the first rows' covariance is lost in rounding, all results are NaN.
  ArfimaFactor(double delta, Eigen::VectorXd phi, const std::vector<Eigen::Index>& lengths);

  /// ln det Gamma of a block of one of these lengths.
  double log_determinant(Eigen::Index rows) const;
  double log_determinant(const std::vector<Eigen::Index>& blocks) const;  // their sum

  void whiten(Eigen::Ref<Eigen::VectorXd> x) const;  // x becomes W x
  /// The same of each block, one after another in x.
  void whiten(Eigen::Ref<Eigen::VectorXd> x, const std::vector<Eigen::Index>& blocks) const;
  void colour(Eigen::Ref<Eigen::VectorXd> x) const;  // x becomes W^-1 x
  /// x becomes W' x. Without an AR only.
  void whiten_backwards(Eigen::Ref<Eigen::VectorXd> x) const;

 private:
  struct Head {              // the first rows of a block, min(p, rows), given the others
    Eigen::MatrixXd factor;  // lower: of their covariance
    double log_determinant;
  };

  void whiten_fractional(Eigen::Ref<Eigen::VectorXd> u) const;
  void colour_fractional(Eigen::Ref<Eigen::VectorXd> u) const;

  double delta_;
  Eigen::VectorXd phi_;
  FractionalDifference difference_;
  Eigen::VectorXd gain_;                         // g_s / g_0; none where delta is 0
  Eigen::VectorXd precision_;                    // 1 / (g_t / g_0 sqrt v_t)
  std::map<Eigen::Index, double> log_variance_;  // sum of ln v, by a block's rows behind its head
  Eigen::MatrixXd regression_;          // p x rows: of the first rows on the whitened later ones
  std::map<Eigen::Index, Head> heads_;  // by the rows of a block
};

}  // namespace sepcal::noise
