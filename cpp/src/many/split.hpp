// SPDX-License-Identifier: BSD-3-Clause
// Parameters parted into each flight's own and those that all flights share.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "estimation/minimise.hpp"
#include "estimation/problem.hpp"

namespace sepcal::many {

/// Places among the problem's free parameters; both in the model's order.
struct Split {
  std::vector<Eigen::Index> own;
  std::vector<Eigen::Index> shared;

  Eigen::Index n_own() const { return static_cast<Eigen::Index>(own.size()); }
  Eigen::Index n_shared() const { return static_cast<Eigen::Index>(shared.size()); }

  /// Own, then shared: the order of a flight's x and of its factors' columns.
  std::vector<Eigen::Index> order() const;
};

/// Throws Error for a name that is no parameter, is fixed or stands there twice, and where nothing
/// is shared.
Split split(const estimation::Problem& problem, const std::vector<std::string>& own);

/// The same with so many noises, which follow the free parameters, at the end of the shared ones.
Split split_with_noises(const estimation::Problem& problem, const std::vector<std::string>& own,
                        Eigen::Index noises);

/// Free parameters in a split's order.
std::vector<Variable> variables(const estimation::Problem& problem, const Split& split);

/// How the parameters of all flights stand in one vector: own of flight 0, own of flight 1, ...,
/// shared.
struct Layout {
  Eigen::Index flights = 0;
  Eigen::Index own = 0;
  Eigen::Index shared = 0;

  Eigen::Index size() const { return flights * own + shared; }

  /// A flight's own parameters, and those that all share.
  auto own_of(Eigen::VectorXd& x, Eigen::Index flight) const {
    return x.segment(flight * own, own);
  }
  auto own_of(const Eigen::VectorXd& x, Eigen::Index flight) const {
    return x.segment(flight * own, own);
  }

  /// Where a flight's k-th of [own | shared] stands.
  Eigen::Index place(Eigen::Index flight, Eigen::Index k) const {
    return k < own ? flight * own + k : (flights - 1) * own + k;
  }

  /// [own | shared] of a flight.
  Eigen::VectorXd point(const Eigen::VectorXd& x, Eigen::Index flight) const {
    Eigen::VectorXd point(own + shared);
    point << own_of(x, flight), x.tail(shared);
    return point;
  }

  /// A flight's [own | shared] repeated for all.
  Eigen::VectorXd repeat(const Eigen::VectorXd& point) const {
    Eigen::VectorXd x(size());
    x << point.head(own).replicate(flights, 1), point.tail(shared);
    return x;
  }
};

}  // namespace sepcal::many
