// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/first_order_lag.hpp"

#include <cmath>

#include "sepcal/error.hpp"
#include "simulation/simulated_flight.hpp"

namespace sepcal::simulation {
namespace {

constexpr double longest_step = 0.005;  // [s]
constexpr double settled = 25.0;        // time constants: e^-25 of a start is left

}  // namespace

FirstOrderLag::FirstOrderLag(const std::string& effect, double tau, double begin, Input input)
    : tau_(tau), input_(std::move(input)), time_(begin - settled * tau) {
  if (!(tau >= 0.0 && tau <= longest_lag)) {
    throw Error(effect + ": tau = " + format_number(tau) + " s is out of range; choose 0 to " +
                format_number(longest_lag) + " s");
  }
  now_ = output_ = input_(time_);
}

Eigen::VectorXd FirstOrderLag::advance_to(double time) {
  if (tau_ == 0.0) return input_(time);
  const double span = time - time_;
  const auto steps = static_cast<int>(std::ceil(span / longest_step));
  for (int k = 0; k < steps; ++k) step(span / steps);
  time_ = time;
  return output_;
}

void FirstOrderLag::step(double length) {
  const Eigen::VectorXd middle = input_(time_ + 0.5 * length);
  const Eigen::VectorXd next = input_(time_ + length);
  // u = now + slope s + curve s^2; y = base + rate s + curve s^2 solves the equation but for the
  // start.
  const Eigen::VectorXd slope = (4.0 * middle - 3.0 * now_ - next) / length;
  const Eigen::VectorXd curve = 2.0 * (now_ - 2.0 * middle + next) / (length * length);
  const Eigen::VectorXd rate = slope - 2.0 * tau_ * curve;
  const Eigen::VectorXd base = now_ - tau_ * rate;
  output_ += (output_ - base) * std::expm1(-length / tau_) + length * (rate + length * curve);
  now_ = next;
  time_ += length;
}

}  // namespace sepcal::simulation
