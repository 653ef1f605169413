// SPDX-License-Identifier: BSD-3-Clause
// Is a candidate more than noise? A likelihood ratio in each of two families of noise, and one in
// their union, each held against draws of the noise that it must not be mistaken for: of either
// family as the record has it without the candidate, and with it. A wandering noise that is no
// member of one family is one of the other; and draws of the noise beside the candidate know what
// noise is there once the candidate's own share is taken out.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "base/thread_pool.hpp"
#include "diagnosis/linearisation.hpp"
#include "noise/noise_families.hpp"

namespace sepcal::diagnosis {

using NoiseMembers = std::vector<noise::NoiseMember>;  // of each used output, in units of its RMSE

/// Columns and noise, estimated together by maximum likelihood.
struct FamilyFit {
  NoiseMembers noise = {};
  double minus_two_log_likelihood = 0.0;
  Eigen::VectorXd coefficients = {};  // of the columns
  Eigen::MatrixXd covariance = {};
};

/// log10 of the two tails; `either` is of the worse family.
struct NoiseTails {
  double either = 0.0;
  double beside = 0.0;  // of the union, in the noise that is there beside the candidate

  /// log10 of what the verdict takes for the probability.
  double log10_p() const { return 0.7 * either + 0.3 * beside; }
};

class NoiseTest {
 public:
  /// `fit` must outlive it. `basis`: orthonormal, of the tangent. `orders`: of each used output's
  /// autoregression in the fractional family.
  NoiseTest(const Linearisation& fit, Eigen::MatrixXd basis, std::vector<int> orders);

  /// Twice the logarithms of the ratios, not negative, for columns that are orthonormal and
  /// orthogonal to the basis.
  struct Ratios {
    std::array<double, 2> own = {};  // of noise::noise_families
    double joint = 0.0;              // of their union
    FamilyFit with = {};             // of the columns [basis, added], in the union
  };
  Ratios compare(const Eigen::MatrixXd& added) const;

  /// The tails where every ratio has the chi-squared distribution that it has in large records.
  static NoiseTails tails(const Ratios& ratios, int freedom);

  /// The same with each ratio over the factor by which draws enlarge it. `smooth`: whether the
  /// columns vary slowly; long records are then averaged, else thinned out.
  NoiseTails calibrate(const Ratios& ratios, const Eigen::MatrixXd& added, bool smooth, int draws,
                       std::uint64_t seed, base::ThreadPool& pool) const;

  /// Columns of count() rows in these noises.
  void whiten(const NoiseMembers& noise, Eigen::MatrixXd& columns) const;

  /// The innovations' standard deviation over all outputs, in their unit.
  double floor(const NoiseMembers& noise) const;

 private:
  const Linearisation& fit_;
  Eigen::MatrixXd basis_;
  std::vector<int> orders_;
  noise::NoiseFamilies families_;
  std::array<FamilyFit, 2> nulls_;
};

}  // namespace sepcal::diagnosis
