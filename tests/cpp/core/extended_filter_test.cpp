// SPDX-License-Identifier: BSD-3-Clause
// The extended filter: its steps against closed forms and fine integration, its use at irregular
// times by its own statistics.
#include "sepcal/states/extended_filter.hpp"

#include <doctest/doctest.h>

#include "draws.hpp"
#include "sepcal/detail/states/autodiff.hpp"
#include "sepcal/states/filter.hpp"

namespace extended_filter_test {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using sepcal::Filter;
using sepcal::propagate;
using sepcal::test::Draws;

namespace {

/// A pendulum with drag under a torque that is linear in time: angle (rad), rate (rad/s).
struct Pendulum {
  double drag = 0.3;    // 1/s
  double torque = 0.0;  // rad/s^2
  double slope = 0.0;   // rad/s^3

  template <class T>
  Eigen::Vector<T, 2> derive(const Eigen::Vector<T, 2>& x, double t) const {
    using std::sin;
    return {x[1], -9.0 * sin(x[0]) - drag * x[1] + T(torque + slope * t)};
  }
  Vector2d rate(const Vector2d& x, double t) const { return derive(x, t); }
  Matrix2d rate_jacobian(const Vector2d& x, double t) const {
    return sepcal::differentiate([&](const auto& y) { return derive(y, t); }, x).jacobian;
  }
  Eigen::Matrix<double, 2, 1> noise_input(const Vector2d& /*x*/, double /*t*/) const {
    return {0.0, 1.0};
  }
};

using One = Eigen::Matrix<double, 1, 1>;

}  // namespace

TEST_CASE("the Jacobian by dual numbers is that of the formula") {
  const Vector2d x(0.7, -0.4);
  Matrix2d expected;
  expected << 0.0, 1.0, -9.0 * std::cos(0.7), -0.3;
  CHECK((Pendulum{}.rate_jacobian(x, 0.0) - expected).norm() < 1e-15);
}

TEST_CASE("a step's state, Phi and Q_d approach those of many small steps, order by order") {
  const Pendulum system{.torque = 1.0, .slope = -2.0};
  const Vector2d x(0.8, 1.5);
  const auto fine = propagate(system, x, One(0.04), 0.0, 0.4, 1e-4);
  const auto error = [&](double dt) {
    const auto coarse = propagate(system, x, One(0.04), 0.0, 0.4, dt);
    CHECK(coarse.Gamma == Matrix2d::Identity());
    return Eigen::Vector3d((coarse.x - fine.x).norm(), (coarse.Phi - fine.Phi).norm(),
                           (coarse.Q_d - fine.Q_d).norm() / fine.Q_d.norm());
  };
  const Eigen::Array3d ratio = error(0.05).array() / error(0.025).array();
  CHECK(ratio[0] == doctest::Approx(16.0).epsilon(0.2));  // fourth order
  CHECK(ratio[1] == doctest::Approx(4.0).epsilon(0.2));   // second, by the state half-way
  CHECK(ratio[2] == doctest::Approx(4.0).epsilon(0.2));
  CHECK((error(0.02).array() < Eigen::Array3d(1e-5, 1e-3, 1e-3)).all());

  // Phi of the whole is the derivative of the end by the begin.
  for (int k = 0; k < 2; ++k) {
    Vector2d h = Vector2d::Zero();
    h[k] = 1e-5;
    const Vector2d slope = (propagate(system, Vector2d(x + h), One(0.0), 0.0, 0.4, 1e-3).x -
                            propagate(system, Vector2d(x - h), One(0.0), 0.0, 0.4, 1e-3).x) /
                           2e-5;
    CHECK((fine.Phi.col(k) - slope).norm() < 1e-6);
  }
}

TEST_CASE("a linear system's step is exact for any dt: Phi and Q_d are those of discretise()") {
  struct Lag {
    Eigen::Vector<double, 1> rate(const Eigen::Vector<double, 1>& x, double) const {
      return -2 * x;
    }
    One rate_jacobian(const Eigen::Vector<double, 1>&, double) const { return One(-2.0); }
    One noise_input(const Eigen::Vector<double, 1>&, double) const { return One(3.0); }
  };
  for (const double step : {0.5, 0.1, HUGE_VAL}) {
    const auto to = propagate(Lag{}, Eigen::Vector<double, 1>(1.0), One(0.2), 1.0, 1.5, step);
    CHECK(to.Phi(0, 0) == doctest::Approx(std::exp(-1.0)).epsilon(1e-14));
    CHECK(to.Q_d(0, 0) == doctest::Approx(0.45 * (1.0 - std::exp(-2.0))).epsilon(1e-13));
  }
}

TEST_CASE("at irregular times with missing outputs its errors are what it says they are") {
  // Angle to 0.02 rad, quantised to 0.005, rate to 0.05 rad/s; a third of the rates is missing,
  // times jitter, some gaps are long. The truth is integrated in steps of 1 ms with its noise.
  const Pendulum system;
  const double density = 0.05;  // (rad/s^2)^2 s
  Matrix2d R = Vector2d(0.02 * 0.02 + 0.005 * 0.005 / 12.0, 0.05 * 0.05).asDiagonal();
  double square = 0.0;  // of errors and innovations, each of mean one
  double surprise = 0.0;
  int errors = 0;
  int innovations = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U}) {
    Draws draws(seed);
    Filter<2> filter(Vector2d(0.5, 0.0), Matrix2d(Vector2d(0.04, 0.25).asDiagonal()));
    Vector2d truth = filter.x() + Vector2d(0.2 * draws.normal(), 0.5 * draws.normal());
    double t = 0.0;
    for (int k = 0; k < 150; ++k) {
      const int steps = static_cast<int>(k % 25 == 24 ? 400.0 : draws.uniform(15.0, 70.0));
      for (int i = 0; i < steps; ++i) {
        truth = propagate(system, truth, One(0.0), 0.0, 1e-3).x;
        truth[1] += std::sqrt(density * 1e-3) * draws.normal();
      }
      const double next = t + 1e-3 * steps;
      filter.predict(propagate(system, filter.x(), One(density), t, next, 0.05));
      t = next;
      Vector2d y = truth + Vector2d(0.02 * draws.normal(), 0.05 * draws.normal());
      y[0] = 0.005 * std::round(y[0] / 0.005);
      if (k % 3 == 0) y[1] = std::nan("");
      const auto innovation =
          filter.update(y, sepcal::Linearisation<2, 2>{filter.x(), Matrix2d::Identity()}, R);
      surprise += innovation.w.squaredNorm();
      innovations += innovation.count;
      if (k % 10 != 9) continue;  // errors further apart depend little on each other
      const auto estimate = filter.estimate();
      square += sepcal::states::solve_transposed(estimate.root, Vector2d(truth - estimate.x))
                    .squaredNorm();
      errors += 2;
    }
  }
  // Sums of squares of unit normals: four standard deviations of their mean.
  CHECK(surprise / innovations == doctest::Approx(1.0).epsilon(4.0 * std::sqrt(2.0 / innovations)));
  CHECK(square / errors == doctest::Approx(1.0).epsilon(4.0 * std::sqrt(2.0 / errors)));
}

TEST_CASE("a state that runs away is refused by the filter") {
  struct Runaway {
    Eigen::Vector<double, 1> rate(const Eigen::Vector<double, 1>& x, double) const {
      return x.array().square().matrix();
    }
    One rate_jacobian(const Eigen::Vector<double, 1>& x, double) const { return 2 * x; }
    One noise_input(const Eigen::Vector<double, 1>&, double) const { return One(1.0); }
  };
  Filter<1> filter(Eigen::Vector<double, 1>(1.0), One(1.0));
  CHECK(filter.predict(propagate(Runaway{}, filter.x(), One(0.1), 0.0, 3.0, 0.01)) ==
        sepcal::FilterStatus::refused);
  CHECK(filter.x()[0] == 1.0);
  for (const double step : {0.0, -1.0, std::nan("")}) {  // ends, whatever is asked for
    const auto to = propagate(Runaway{}, filter.x(), One(0.1), 0.0, 0.5, step);
    CHECK(to.x.allFinite() == (step != 0.0));
  }
  CHECK(filter.predict(propagate(Runaway{}, filter.x(), One(0.1), 0.5, 0.0)) ==
        sepcal::FilterStatus::refused);  // time that runs backwards
}

TEST_CASE("a model in discrete time is a transition as it stands: bias times gain, both unknown") {
  const auto next = [](const auto& x) {
    using T = std::decay_t<decltype(x)>::Scalar;
    return Eigen::Vector<T, 2>(x[0] * x[1], x[1]);
  };
  const auto f = sepcal::differentiate(next, Vector2d(2.0, 0.5));
  Matrix2d expected;
  expected << 0.5, 2.0, 0.0, 1.0;
  CHECK(f.jacobian == expected);
  Filter<2> filter(Vector2d(2.0, 0.5), Matrix2d::Identity());
  filter.predict(sepcal::Transition<2, 1>{f.value, f.jacobian, {1.0, 0.0}, One(0.25)});
  CHECK(filter.x() == Vector2d(1.0, 0.5));
  Matrix2d P = expected * expected.transpose();
  P(0, 0) += 0.25;
  CHECK((filter.covariance() - P).norm() < 1e-14);
}

}  // namespace extended_filter_test
