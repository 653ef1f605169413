// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/sqp.hpp"

#include <cmath>
#include <nlopt.hpp>

#include "estimation/nlopt_cost.hpp"

namespace sepcal::estimation {
namespace {

using Eigen::VectorXd;

struct Share final : SquareScale {
  explicit Share(double rows_) : rows(rows_) {}
  double value(double square) const override {
    return std::isfinite(square) ? 0.5 * square / rows : infinity;
  }
  double slope(double /*square*/) const override { return 0.5 / rows; }
  double rows;
};

}  // namespace

Descent descend_by_sqp(Objective& objective, const VectorXd& start, const numerics::Box& box,
                       const VectorXd& widths, const SqpOptions& options) {
  constexpr double tolerance = 1e-12;  // of the cost and of each parameter
  const VectorXd from = box.clip(start);
  const Share share(options.rows);
  NloptCost cost(objective, share, VectorXd::Zero(from.size()), widths);
  nlopt::opt solver(nlopt::LD_SLSQP, static_cast<unsigned>(from.size()));
  solver.set_lower_bounds(values_in(box.lower.cwiseQuotient(widths)));
  solver.set_upper_bounds(values_in(box.upper.cwiseQuotient(widths)));
  solver.set_maxeval(options.evaluations);
  solver.set_ftol_rel(tolerance);
  solver.set_xtol_rel(tolerance);
  const bool converged = cost.minimise(solver, values_in(from.cwiseQuotient(widths)));
  Descent end = cost.lowest();
  if (end.x.size() == 0) end.x = from;
  end.x = box.clip(end.x);
  end.converged = converged && std::isfinite(end.square);
  return end;
}

}  // namespace sepcal::estimation
