// SPDX-License-Identifier: BSD-3-Clause
// (1 - B)^d x with B the shift by one row: y_t = sum_{k<=t} pi_k x_{t-k}, pi_k = prod (j-1-d)/j.
// For 0 < d < 1 and k > d
//   pi_k = -sin(pi d)/pi  integral of e^{-(k-d) lambda} (1 - e^{-lambda})^d over lambda,
// so that a few dozen exponentials give every late coefficient at once, in time linear in the rows.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sepcal::noise {

/// Eight terms w e^{-lambda k} of a sum over the rows k that are gone by.
struct Exponentials {
  static constexpr int count = 8;
  alignas(64) double decay[count] = {};   // e^{-lambda}
  alignas(64) double weight[count] = {};  // w
};

class FractionalDifference {
 public:
  /// For columns of up to `rows` rows; -1 <= d < 1. Against the sum itself y is off by less than
  /// 1e-9 of the largest |x| (times the rows, below d = 0, where y itself grows so).
  FractionalDifference(double d, Eigen::Index rows);

  /// x becomes (1 - B)^d x; what is before the first row counts as zero.
  void apply(Eigen::Ref<Eigen::VectorXd> x) const;

 private:
  double d_;                           // of the coefficients below, in [0, 1)
  bool summed_;                        // (1 - B)^{d-1} is a running sum of (1 - B)^d
  Eigen::VectorXd near_;               // the first coefficients, one by one, the last first
  std::vector<Exponentials> distant_;  // all others
};

}  // namespace sepcal::noise
