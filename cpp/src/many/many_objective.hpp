// SPDX-License-Identifier: BSD-3-Clause
// The compressed problem of many flights: for each one n + 1 whitened residuals [q; rho] and their
// Jacobian -[R; 0] in [own | shared], asked of the source once a point.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "estimation/plausibility.hpp"
#include "many/split.hpp"
#include "sepcal/fit_many.hpp"

namespace sepcal::many {

class ManyObjective {
 public:
  /// `flights`: the places in the source of those that take part. The source must outlive this.
  ManyObjective(FlightSource& source, std::vector<std::size_t> flights, const Layout& layout)
      : source_(source),
        flights_(std::move(flights)),
        layout_(layout),
        prior_{Eigen::VectorXd::Zero(layout.own + layout.shared),
               Eigen::VectorXd::Zero(layout.own + layout.shared)} {}

  const Layout& layout() const { return layout_; }
  std::size_t flight(Eigen::Index i) const { return flights_[static_cast<std::size_t>(i)]; }

  /// 1 / noise standard deviation of each output (n_z). Needs no pass.
  void weigh(const Eigen::VectorXd& weights);

  /// The prior of [own | shared]: that of own ones holds in every flight, that of shared ones once.
  void set_prior(const estimation::Prior& prior);

  /// Loose priors that hold [own | shared] of each flight for a while; empty: none.
  void hold(std::vector<estimation::Prior> loose);

  /// Goes to x; a pass over the data unless it is there already. False where a model is not finite.
  bool linearise(const Eigen::VectorXd& x);

  /// At the point linearised last: a whitened factor of [own | shared | r] a flight. Their sum is
  /// the whole problem: the prior of shared parameters and what holds them stand in the first.
  const std::vector<TriangularFactor>& blocks() const { return blocks_; }

  /// What each flight has to say, whitened by `weights`: its data, and the prior of its own
  /// parameters.
  std::vector<TriangularFactor> flight_blocks(const Eigen::VectorXd& weights) const;
  std::vector<TriangularFactor> flight_blocks() const { return flight_blocks(weights_); }

  /// The prior of the shared parameters: the factor of [shared | r].
  TriangularFactor shared_prior() const;

  /// 1 / standard deviation of the prior of [own | shared], 0 where there is none.
  const Eigen::VectorXd& prior_weights() const { return prior_.weight; }

  /// n_z factors of each flight, not whitened.
  const std::vector<std::vector<TriangularFactor>>& factors() const { return factors_; }

  /// Sum of squared residuals of a flight by output (n_z).
  Eigen::VectorXd squares(Eigen::Index i) const;

  /// Sum of whitened squares over all flights, with the prior and what holds.
  double square() const;

  int passes() const { return passes_; }

 private:
  void combine_blocks();

  FlightSource& source_;
  std::vector<std::size_t> flights_;
  Layout layout_;
  Eigen::VectorXd weights_;
  estimation::Prior prior_;
  std::vector<estimation::Prior> loose_;
  Eigen::VectorXd at_;
  std::vector<std::vector<TriangularFactor>> factors_;
  std::vector<TriangularFactor> blocks_;
  int passes_ = 0;
};

}  // namespace sepcal::many
