// SPDX-License-Identifier: BSD-3-Clause
#include "many/joint_start.hpp"

#include <algorithm>
#include <cmath>

#include "many/arrowhead.hpp"
#include "numerics/order_statistics.hpp"

namespace sepcal::many {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

/// Each flight's factor at its own estimate, its own parameters eliminated.
std::vector<Share> own_shares(const std::vector<FlightStart>& starts, bool whitened, Index n_own) {
  std::vector<Share> shares;
  for (const FlightStart& start : starts) {
    const VectorXd weights = whitened ? VectorXd::Ones(1) : VectorXd(start.noise.cwiseInverse());
    shares.push_back(eliminate_own(combine(start.factors, weights).matrix(), n_own));
  }
  return shares;
}

std::vector<bool> find_usable(const std::vector<FlightStart>& starts) {
  const bool none_converged = std::ranges::all_of(
      starts, [](const FlightStart& start) { return start.status == FitStatus::not_converged; });
  std::vector<bool> usable;
  for (const FlightStart& start : starts) {
    usable.push_back(none_converged || start.status != FitStatus::not_converged);
  }
  return usable;
}

/// argmin sum_i |R_i (theta - theta_i)|^2 over the shared parameters.
VectorXd weighted_mean(const std::vector<FlightStart>& starts, const std::vector<Share>& shares,
                       const std::vector<bool>& usable, Index n_shared) {
  TriangularFactor merged(static_cast<int>(n_shared + 1));
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (!usable[i] || !shares[i].shared.all_finite()) continue;
    Eigen::MatrixXd rows = shares[i].shared.matrix();
    rows.col(n_shared) = rows.leftCols(n_shared) * starts[i].x.tail(n_shared);
    merged.absorb(rows);
  }
  const Eigen::MatrixXd& T = merged.matrix();
  return solve_triangular(T.topLeftCorner(n_shared, n_shared), T.col(n_shared).head(n_shared)).x;
}

VectorXd medians(const std::vector<FlightStart>& starts, const std::vector<bool>& usable,
                 Index n_shared) {
  VectorXd medians(n_shared);
  for (Index k = 0; k < n_shared; ++k) {
    std::vector<double> values;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      if (usable[i]) values.push_back(starts[i].x.tail(n_shared)[k]);
    }
    medians[k] = numerics::upper_median(std::move(values));
  }
  return medians;
}

}  // namespace

VectorXd pooled_noise(const std::vector<FlightStart>& starts) {
  VectorXd squares = VectorXd::Zero(starts.front().noise.size());
  double rows = 0.0;
  for (const FlightStart& start : starts) {
    squares += static_cast<double>(start.rows) * start.noise.cwiseAbs2();
    rows += static_cast<double>(start.rows);
  }
  return (squares / rows).cwiseSqrt();
}

std::vector<VectorXd> joint_starts(const std::vector<FlightStart>& starts, bool whitened,
                                   const Layout& layout, const numerics::Box& box) {
  const std::vector<Share> shares = own_shares(starts, whitened, layout.own);
  const std::vector<bool> usable = find_usable(starts);
  std::vector<VectorXd> joint;
  for (const VectorXd& shared : {weighted_mean(starts, shares, usable, layout.shared),
                                 medians(starts, usable, layout.shared)}) {
    if (!shared.allFinite()) continue;
    VectorXd x(layout.size());
    x.tail(layout.shared) = shared;
    for (Index i = 0; i < layout.flights; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const VectorXd moved = shared - starts[at].x.tail(layout.shared);
      const VectorXd follows = solve_triangular(shares[at].own, -shares[at].cross * moved).x;
      layout.own_of(x, i) = starts[at].x.head(layout.own) + follows;
    }
    x = box.clip(x);
    if (x.allFinite()) joint.push_back(std::move(x));
  }
  return joint;
}

VectorXd find_joint_start(ManyObjective& objective, const std::vector<FlightStart>& starts,
                          const numerics::Box& box) {
  VectorXd best;
  double least = infinity;
  for (const VectorXd& x : joint_starts(starts, false, objective.layout(), box)) {
    if (!objective.linearise(x) || !(objective.square() < least)) continue;
    least = objective.square();
    best = x;
  }
  if (best.size() == 0) best = box.clip(objective.layout().repeat(starts.front().x));
  objective.linearise(best);
  return best;
}

}  // namespace sepcal::many
