// SPDX-License-Identifier: BSD-3-Clause
// Fisher's information of filter error's score rows against the scores of many flights. A standard
// deviation of 400 numbers is 3.5 % uncertain itself, the worst of fifteen some 8 %: of 24 times
// 400 flights three had one beyond 10 %. Whether there is more than chance 9,600 flights tell.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "sepcal/detail/innovation_model.hpp"
#include "sepcal/detail/states/compiled_trajectories.hpp"
#include "sepcal/detail/triangular_factor.hpp"
#include "sepcal/models/short_period.hpp"
#include "short_periods.hpp"
#include "studies/seeds.hpp"

namespace scores_study {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using sepcal::ShortPeriod;
using sepcal::test::ShortPeriodFlight;

TEST_CASE("the scores of many flights vary as Fisher's information says") {
  constexpr int flights = sepcal::test::seeds(9600, 400);
  constexpr double tolerance = sepcal::test::whole_study ? 0.025 : 0.1;
  VectorXd theta(15);  // what is flown: b_alpha b_q b_az Zd Md alpha_0 q_0 Za Ma Mq ln q ln r
  theta << 0.02, -0.01, 0.5, -0.35, -45, 0.01, -0.05, -4, -40, -5, std::log(0.003), std::log(0.09),
      std::log(0.005), std::log(0.01), std::log(0.15);
  const Index n = theta.size();
  MatrixXd scores(flights, n);
  MatrixXd information = MatrixXd::Zero(n, n);
  for (int i = 0; i < flights; ++i) {
    ShortPeriodFlight flight;
    flight.process_noise = {0.003, 0.09};
    flight.rows = 400;
    flight.seed = static_cast<std::uint64_t>(1000 + i);
    const sepcal::Record record = fly_short_period(flight);
    const sepcal::TrajectoryModel<ShortPeriod> model(ShortPeriod(), record);
    sepcal::TriangularFactor factor(static_cast<int>(n) + 1);
    model.innovations(record)->scores(
        theta, [&](std::size_t /*row*/, MatrixXd& rows) { factor.absorb(rows); });
    const MatrixXd R = factor.matrix().topLeftCorner(n, n);
    scores.row(i) = (R.transpose() * factor.matrix().topRightCorner(n, 1)).transpose();
    information += R.transpose() * R / flights;
  }
  double worst = 0.0;
  for (Index i = 0; i < n; ++i) {
    CAPTURE(i);
    const double spread = std::sqrt(scores.col(i).squaredNorm() / flights);
    const double off = spread / std::sqrt(information(i, i)) - 1.0;
    worst = std::max(worst, std::abs(off));
    CHECK(std::abs(off) < tolerance);
    CHECK(std::abs(scores.col(i).mean()) < 4.0 * std::sqrt(information(i, i) / flights));
  }
  MESSAGE("of ", flights, " flights the scores' standard deviations are ", 100.0 * worst,
          " % off at most");
}

}  // namespace scores_study
