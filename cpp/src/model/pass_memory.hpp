// SPDX-License-Identifier: BSD-3-Clause
// The last few passes and what they gave: a descent, the last digits behind it and what judges its
// end ask for the same points again.
#pragma once

#include <Eigen/Core>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "sepcal/detail/triangular_factor.hpp"

namespace sepcal::model {

class PassMemory {
 public:
  using Factors = std::vector<TriangularFactor>;

  /// What pass(point) gives, from memory where this very point was asked for lately.
  template <class Pass>
  Factors at(const Eigen::VectorXd& point, const Pass& pass) {
    if (auto known = find(point)) return std::move(*known);
    Factors factors = pass();
    keep(point, factors);
    return factors;
  }

 private:
  std::optional<Factors> find(const Eigen::VectorXd& point) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [known, factors] : kept_) {
      if (known.size() == point.size() && known == point) return factors;
    }
    return {};
  }

  void keep(const Eigen::VectorXd& point, const Factors& factors) {
    constexpr std::size_t most = 4;
    const std::lock_guard lock(mutex_);
    if (kept_.size() == most) kept_.erase(kept_.begin());
    kept_.emplace_back(point, factors);
  }

  mutable std::mutex mutex_;
  std::vector<std::pair<Eigen::VectorXd, Factors>> kept_;
};

}  // namespace sepcal::model
