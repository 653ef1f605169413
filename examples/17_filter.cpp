// SPDX-License-Identifier: BSD-3-Clause
// Height and climb of an aircraft from a barometric altimeter whose samples come when they come and
// are sometimes lost: filtered as in flight, then smoothed. Exits 1 where the truth is missed.
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <sepcal/states/discretise.hpp>
#include <sepcal/states/filter.hpp>
#include <sepcal/states/smoother.hpp>

int main() {
  using Eigen::Matrix2d, Eigen::Vector2d;
  using Reading = Eigen::Vector<double, 1>;
  const Matrix2d F{{0, 1}, {0, 0}};          // height (m), climb (m/s)
  const Matrix2d density{{0, 0}, {0, 0.5}};  // of the acceleration, m^2/s^3
  const sepcal::LinearOutputs<1, 2> altimeter{Eigen::RowVector2d(1, 0)};  // sees the height
  const Eigen::Matrix<double, 1, 1> R{4.0};                               // to 2 m
  const auto climb = [](double t) { return 5.0 * std::sin(0.1 * t); };

  constexpr std::size_t rows = 300;
  std::array<sepcal::Stage<2>, rows> pass;
  std::array<sepcal::Smoothed<2>, rows> smoothed;
  std::array<double, rows> times{};
  std::mt19937 generator(1);
  std::normal_distribution noise(0.0, 2.0);
  std::uniform_real_distribution interval(0.1, 0.5);
  sepcal::Filter<2> filter(Vector2d(0, 0), Matrix2d{{1e8, 0}, {0, 1e4}});
  double t = 0;
  for (std::size_t k = 0; k < rows; ++k) {
    const double truth = 1000 + 50 * (1 - std::cos(0.1 * t));
    const bool lost = k % 50 > 40;
    const Reading y(lost ? std::numeric_limits<double>::quiet_NaN() : truth + noise(generator));
    filter.update(y, altimeter.at(filter.x(), Reading(0.0)), R);

    const double dt = interval(generator);
    const auto [Phi, Q_d] = sepcal::discretise<2>(F, density, dt);
    const sepcal::LinearDynamics<2> step{Phi, Matrix2d::Identity(), Q_d};
    pass[k] = {filter.estimate(), step.from(filter.x(), Vector2d::Zero())};
    filter.predict(pass[k].next);
    times[k] = t;
    t += dt;
  }
  sepcal::smooth(pass, smoothed);

  double filtered = 0, later = 0, said = 0;  // mean squares of the climb's error, and what P says
  for (std::size_t k = 0; k < rows; ++k) {
    filtered += std::pow(pass[k].filtered.x[1] - climb(times[k]), 2) / rows;
    later += std::pow(smoothed[k].x[1] - climb(times[k]), 2) / rows;
    said += smoothed[k].P(1, 1) / rows;
  }
  std::printf("climb: %.2f m/s rms as it was flown, %.2f smoothed, %.2f by its covariance\n",
              std::sqrt(filtered), std::sqrt(later), std::sqrt(said));
  return later < filtered && later < 4 * said ? 0 : 1;
}
