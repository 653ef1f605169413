// SPDX-License-Identifier: BSD-3-Clause
// Is a candidate more than noise? A likelihood ratio in each of two families of noise of the
// outputs (and in one of the inputs, where these wander), and one in the union of all, each
// held against draws of the noise that it must not be mistaken for: of either family as the record
// has it without the candidate, and with it. A wandering noise that is no member of one family is
// one of the other; and draws of the noise beside the candidate know what noise is there once the
// candidate's own share is taken out.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/thread_pool.hpp"
#include "diagnosis/family_fit.hpp"
#include "diagnosis/input_drift.hpp"
#include "diagnosis/known_products.hpp"
#include "diagnosis/projection.hpp"

namespace sepcal::diagnosis {

/// log10 of the two tails; `either` is of the worse family.
struct NoiseTails {
  double either = 0.0;
  double beside = 0.0;  // of the union, in the noise that is there beside the candidate

  /// log10 of what the verdict takes for the probability.
  double log10_p() const { return 0.7 * either + 0.3 * beside; }
};

class NoiseTest {
 public:
  /// The tangent's fit must outlive it. `orders`: of each used output's autoregression in the
  /// fractional family.
  NoiseTest(const TangentBasis& tangent, std::vector<int> orders);

  /// Twice the logarithms of the ratios, not negative, for columns that are orthonormal and
  /// orthogonal to the basis.
  struct Ratios {
    std::array<double, 2> own = {};  // of noise::noise_families
    double of_inputs = infinity;     // beside inputs that wander; infinite where none do
    double joint = 0.0;              // of the union of all
    FamilyFit with = {};             // of the columns [basis, added], in the union of those two
    bool inputs_drift = false;       // beside the columns noise of inputs is the likeliest
  };
  Ratios compare(const Columns& added) const;

  /// The tails where every ratio has the chi-squared distribution that it has in large records.
  static NoiseTails tails(const Ratios& ratios, int freedom);

  /// How a calibration draws.
  struct Drawing {
    int draws = 0;  // of each noise
    std::uint64_t seed = 0;
    bool smooth = false;        // the columns vary slowly: long records are averaged, else thinned
    bool beside_alone = false;  // of the noise beside the columns, which stands for the others
  };

  /// The same with each ratio over the factor by which draws enlarge it.
  NoiseTails calibrate(const Ratios& ratios, const Columns& added, const Drawing& drawing,
                       base::ThreadPool& pool) const;

  /// [X e]' [X e] of columns X and a residual e, white in these noises.
  Eigen::MatrixXd products(const NoiseMembers& noise, const Columns& X,
                           const Eigen::VectorXd& e) const;

  /// The innovations' standard deviation over all outputs, in their unit.
  double floor(const NoiseMembers& noise) const;

 private:
  const LinearisedFit& fit_;
  Columns basis_;
  std::vector<int> orders_;
  noise::NoiseFamilies families_;
  std::unique_ptr<const KnownProducts> known_;  // of the basis and the fit's residual
  std::array<FamilyFit, 2> nulls_;
  InputDrift inputs_;
};

}  // namespace sepcal::diagnosis
