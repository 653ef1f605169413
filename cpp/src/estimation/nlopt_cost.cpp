// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/nlopt_cost.hpp"

#include <algorithm>
#include <utility>

namespace sepcal::estimation {

using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<double> values_in(const VectorXd& x) { return {x.begin(), x.end()}; }

NloptCost::NloptCost(Objective& objective, const SquareScale& scale, VectorXd origin,
                     VectorXd widths)
    : objective_(objective),
      scale_(scale),
      origin_(std::move(origin)),
      widths_(std::move(widths)),
      lowest_{{}, infinity} {}

VectorXd NloptCost::point(const std::vector<double>& t) const {
  return origin_ + widths_.cwiseProduct(Map<const VectorXd>(t.data(), origin_.size()));
}

void NloptCost::hear(std::function<void(const VectorXd&, double)> on_point) {
  on_point_ = std::move(on_point);
}

bool NloptCost::minimise(nlopt::opt& solver, std::vector<double> t) {
  solver.set_min_objective(&NloptCost::evaluate, this);
  bool converged = false;
  try {
    double value = 0.0;
    converged = solver.optimize(t, value) != nlopt::MAXEVAL_REACHED;
  } catch (const nlopt::forced_stop&) {
    std::rethrow_exception(failure_);
  } catch (const nlopt::roundoff_limited&) {
    converged = true;  // no better point can be told from the best one
  } catch (const std::exception&) {
    converged = false;  // the best point stands
  }
  return converged;
}

double NloptCost::evaluate(const std::vector<double>& t, std::vector<double>& gradient,
                           void* self) {
  auto& cost = *static_cast<NloptCost*>(self);
  try {
    return cost.at(t, gradient);
  } catch (...) {
    cost.failure_ = std::current_exception();
    throw nlopt::forced_stop();
  }
}

double NloptCost::at(const std::vector<double>& t, std::vector<double>& gradient) {
  const VectorXd x = point(t);
  const double square = gradient.empty() ? objective_.square(x) : differentiate(x, gradient);
  if (square < lowest_.square) {
    lowest_.x = x;
    lowest_.square = square;
  }
  ++lowest_.iterations;
  if (on_point_) on_point_(x, square);
  return scale_.value(square);
}

double NloptCost::differentiate(const VectorXd& x, std::vector<double>& gradient) {
  VectorXd residual;
  MatrixXd jacobian;
  std::ranges::fill(gradient, 0.0);
  if (!objective_.linearise(x, residual, jacobian)) return infinity;
  const double square = residual.squaredNorm();
  Map<VectorXd>(gradient.data(), x.size()) =
      (2.0 * scale_.slope(square)) * widths_.cwiseProduct(jacobian.transpose() * residual);
  return square;
}

}  // namespace sepcal::estimation
