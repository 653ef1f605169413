// SPDX-License-Identifier: BSD-3-Clause
// Products of white columns where most columns are the same every time: what the known ones are in
// a member's noise is found once, and of the others R^-1 X takes the place of their whitening.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "diagnosis/columns.hpp"
#include "diagnosis/family_fit.hpp"
#include "noise/noise_families.hpp"

namespace sepcal::diagnosis {

/// Thread-safe; `families` and `layout` must outlive it, and what the columns are made of.
class KnownProducts {
 public:
  /// Columns B, a residual e, and the orders of each output's autoregression in the fractional
  /// family.
  KnownProducts(const noise::NoiseFamilies& families, const RowLayout& layout, const Columns& B,
                const Eigen::VectorXd& e, std::vector<int> orders);
  ~KnownProducts();
  KnownProducts(const KnownProducts&) = delete;
  KnownProducts& operator=(const KnownProducts&) = delete;
  KnownProducts(KnownProducts&&) = delete;
  KnownProducts& operator=(KnownProducts&&) = delete;

  /// [B X e]' R^-1 [B X e] in these noises, of as many columns X as are added.
  Eigen::MatrixXd beside(const NoiseMembers& noise, const Columns& X) const;

 private:
  struct Output;

  /// [B e]' R^-1 [B e] of an output.
  Eigen::MatrixXd known_square(const noise::NoiseMember& member, std::size_t j) const;
  Eigen::MatrixXd whitened_square(const noise::NoiseMember& member, std::size_t j) const;
  Eigen::MatrixXd known_rows(std::size_t j) const;

  const noise::NoiseFamilies& families_;
  const RowLayout& layout_;
  Columns known_;  // [B e]
  std::vector<int> orders_;
  std::vector<std::unique_ptr<Output>> outputs_;
};

}  // namespace sepcal::diagnosis
