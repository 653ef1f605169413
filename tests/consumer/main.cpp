// SPDX-License-Identifier: BSD-3-Clause
// A user's program, built against an installed sepcal: a model of its own is fitted to data without
// noise, whose parameters must come back; and the flight library must link.
#include <array>
#include <cmath>
#include <cstdio>
#include <sepcal/sepcal.hpp>
#include <sepcal/simulation/simulate.hpp>
#include <vector>

/// An accelerometer on a tilt table: z = s g sin(theta + delta) + bias.
struct TiltTable {
  static constexpr std::array inputs{sepcal::Quantity{"theta", "rad"}};
  static constexpr std::array outputs{sepcal::Quantity{"acceleration", "m/s^2"}};
  static constexpr std::array linear{sepcal::Quantity{"s", "1"}, sepcal::Quantity{"bias", "m/s^2"}};
  static constexpr std::array nonlinear{sepcal::Quantity{"delta", "rad", -0.3, 0.3}};

  template <class U, class X>
  sepcal::Affine<X, 1, 2> at(const sepcal::Vec<U, 1>& u, const sepcal::Vec<X, 1>& xi2) const {
    using std::sin;
    sepcal::Affine<X, 1, 2> z;
    z.A << 9.80665 * sin(u[0] + xi2[0]), X(1.0);
    z.b.setZero();
    return z;
  }
};
static_assert(sepcal::SeparableModel<TiltTable>);

int main() {
  constexpr double s = 1.02;
  constexpr double bias = -0.13;
  constexpr double delta = 0.07;
  std::vector<double> theta(200);
  std::vector<double> acceleration(theta.size());
  for (std::size_t i = 0; i < theta.size(); ++i) {
    theta[i] = 0.03 * static_cast<double>(i);  // nearly one turn
    acceleration[i] = s * 9.80665 * std::sin(theta[i] + delta) + bias;
  }
  sepcal::Record record;
  record.add("theta", theta).add("acceleration", acceleration);

  const sepcal::Fit fit = sepcal::fit(TiltTable{}, record);
  const double error =
      std::hypot(fit["s"].value - s, fit["bias"].value - bias, fit["delta"].value - delta);
  const std::size_t rows = sepcal::simulate_five_hole({}, {.rows = 100}).rows();
  std::printf("fitted within %.1e; simulated %zu rows\n", error, rows);
  return error < 1e-8 && fit.status == sepcal::FitStatus::converged && rows == 100 ? 0 : 1;
}
