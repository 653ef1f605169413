// SPDX-License-Identifier: BSD-3-Clause
// An effect of one's own in C++, joined to a magnetometer's model at compile time, as flight
// software does, and at run time, as the apps do: the same numbers. Exits 1 where they are not, or
// where the truth is missed.
#include <cmath>
#include <cstdio>
#include <random>
#include <sepcal/composition.hpp>
#include <sepcal/sepcal.hpp>
#include <sepcal/static_composition.hpp>
#include <utility>
#include <vector>
using namespace sepcal;
namespace {

// A motor's current, which isn't logged, goes with throttle times voltage.
struct MotorCurrent {
  static constexpr std::array inputs{Quantity{"throttle", "1"}, Quantity{"voltage", "V"}};
  static constexpr std::array<Quantity, 3> linear{
      {{"motor.x", "uT/V"}, {"motor.y", "uT/V"}, {"motor.z", "uT/V"}}};
  static constexpr std::array<Quantity, 0> nonlinear{};
  template <class U, class X>
  Eigen::Matrix<U, 3, 3> columns(const Vec<U, 2>& u, const Vec<X, 0>& /*xi2*/) const {
    return Eigen::Matrix<U, 3, 3>::Identity() * (u[0] * u[1]);
  }
};

constexpr std::array motor_truth{0.8, -0.5, 0.6};  // [uT/V]

/// A field of 53 uT met from all over the sphere, read with hard iron, the motor's field and 0.3 uT
/// of noise.
Record tumble(std::size_t rows) {
  std::mt19937_64 generator(9);
  std::normal_distribution noise(0.0, 0.3);
  std::vector<double> throttle;
  std::vector<double> voltage;
  std::array<std::vector<double>, 3> field;
  std::array<std::vector<double>, 3> reading;
  for (std::size_t i = 0; i < rows; ++i) {
    const auto t = static_cast<double>(i);
    throttle.push_back(0.5 + 0.4 * std::sin(0.11 * t));
    voltage.push_back(24.0 - 0.004 * t);
    const std::array h{53.0 * std::cos(0.37 * t) * std::sin(0.05 * t),
                       53.0 * std::sin(0.37 * t) * std::sin(0.05 * t), 53.0 * std::cos(0.05 * t)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double motor = motor_truth[axis] * throttle.back() * voltage.back();
      field[axis].push_back(h[axis]);
      reading[axis].push_back(h[axis] + 10.0 + motor + noise(generator));
    }
  }
  Record record;
  record.add("throttle", throttle).add("voltage", voltage);
  record.add("hx", field[0]).add("hy", field[1]).add("hz", field[2]);
  record.add("mx", reading[0]).add("my", reading[1]).add("mz", reading[2]);
  return record;
}

Fit fit_at_compile_time(const Record& record) {
  return fit(Magnetometer{} + MotorCurrent{}, record);
}

Fit fit_at_run_time(const Record& record) {
  const std::vector<Effect> effects{effect("motor", MotorCurrent{})};
  return fit(*compose(block_model(Magnetometer{}), effects, record), record);
}

}  // namespace

int main() {
  const Record record = tumble(600);
  const Fit static_fit = fit_at_compile_time(record);
  const Fit dynamic_fit = fit_at_run_time(record);
  bool found = static_fit.status == FitStatus::converged;
  for (const Parameter& p : static_fit.parameters) {
    const Parameter& same = dynamic_fit[p.name];
    std::printf("%-9s %10.6f %10.6f +- %.6f %s\n", p.name.c_str(), p.value, same.value,
                p.standard_error, p.unit.c_str());
    found = found && std::abs(p.value - same.value) < 1e-6 * p.standard_error;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Parameter& motor = static_fit[MotorCurrent::linear[axis].name];
    found = found && std::abs(motor.value - motor_truth[axis]) < 4.0 * motor.standard_error;
  }
  return found ? 0 : 1;
}
