// SPDX-License-Identifier: BSD-3-Clause
// The noise to try next, where R and the parameters settle slowly in turn: where the model lacks
// something, each output's misfit moves the others' weights, and errors may shrink by less than
// half a turn. Anderson, J. ACM 12 (1965) 547; in logarithms, so that scales don't matter.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sepcal::estimation {

/// Mixes the last turns of a fixed point R = g(R). All deviations positive (n_z).
class Acceleration {
 public:
  /// From the deviations of a turn and those of the residuals that came of them, g of the first.
  Eigen::VectorXd next(const Eigen::VectorXd& tried, const Eigen::VectorXd& found);

 private:
  struct Turn {
    Eigen::VectorXd found;   // logarithms
    Eigen::VectorXd change;  // of logarithms: found less tried
  };
  std::vector<Turn> turns_;
  int plain_ = 0;   // turns taken without
  int failed_ = 0;  // turns after which R was no nearer
};

}  // namespace sepcal::estimation
