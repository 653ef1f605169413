// SPDX-License-Identifier: BSD-3-Clause
// The compressed problem of many flights: for each one n + 1 whitened residuals [q; rho] and their
// Jacobian -[R; 0] in [own | shared], asked of the fleet once a point.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "many/split.hpp"
#include "plausibility.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal {

class ManyObjective {
 public:
  /// `flights`: the fleet's places of those that take part. The fleet must outlive this.
  ManyObjective(Fleet& fleet, std::vector<std::size_t> flights, const Layout& layout)
      : fleet_(fleet), flights_(std::move(flights)), layout_(layout) {}

  const Layout& layout() const { return layout_; }
  std::size_t flight(Eigen::Index i) const { return flights_[static_cast<std::size_t>(i)]; }

  /// 1 / noise standard deviation of each output (n_z). Needs no pass.
  void weigh(const Eigen::VectorXd& weights);

  /// What is known of [own | shared] of each flight beforehand; empty: nothing.
  void hold(std::vector<Prior> priors);

  /// Goes to x; a pass over the data unless it is there already. False where a model is not finite.
  bool linearise(const Eigen::VectorXd& x);

  /// At the point linearised last: a whitened factor of [own | shared | r] a flight, priors
  /// included.
  const std::vector<TriangularFactor>& blocks() const { return blocks_; }

  /// The same without priors.
  std::vector<TriangularFactor> data_blocks() const;

  /// n_z factors of each flight, not whitened.
  const std::vector<std::vector<TriangularFactor>>& factors() const { return factors_; }

  /// Sum of squared residuals of a flight by output (n_z).
  Eigen::VectorXd squares(Eigen::Index i) const;

  /// Sum of whitened squares over all flights, priors included.
  double square() const;

  int passes() const { return passes_; }

 private:
  void combine_blocks();

  Fleet& fleet_;
  std::vector<std::size_t> flights_;
  Layout layout_;
  Eigen::VectorXd weights_;
  std::vector<Prior> priors_;
  Eigen::VectorXd at_;
  std::vector<std::vector<TriangularFactor>> factors_;
  std::vector<TriangularFactor> blocks_;
  int passes_ = 0;
};

}  // namespace sepcal
