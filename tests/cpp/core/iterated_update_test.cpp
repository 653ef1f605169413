// SPDX-License-Identifier: BSD-3-Clause
// The iterated update against a search for the least J of S 2.5 that uses values alone.
#include "sepcal/states/iterated_update.hpp"

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <type_traits>

#include "sepcal/detail/states/autodiff.hpp"
#include "sepcal/detail/states/joseph_form.hpp"

namespace iterated_update_test {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using sepcal::Filter;
using sepcal::FilterStatus;
using sepcal::JosephForm;
using sepcal::SquareRootForm;

namespace {

/// Range and bearing of a point.
struct Radar {
  template <class T>
  Eigen::Vector<T, 2> operator()(const Eigen::Vector<T, 2>& x) const {
    using std::atan2;
    using std::sqrt;
    return {sqrt(x[0] * x[0] + x[1] * x[1]), atan2(x[1], x[0])};
  }
};

struct Problem {
  Vector2d prior{1.0, 0.2};
  Matrix2d P = 0.5 * Matrix2d::Identity();
  Matrix2d R = 1e-3 * Matrix2d::Identity();
  Vector2d y = Radar{}(Vector2d(0.6, 0.9));

  double J(const Vector2d& x) const {  // S 2.5
    const Vector2d from_prior = x - prior;
    const Vector2d residual = y - Radar{}(x);
    return 0.5 * from_prior.dot(P.inverse() * from_prior) +
           0.5 * residual.dot(R.inverse() * residual);
  }

  /// Compass search: no derivative, no linearisation.
  Vector2d lowest() const {
    Vector2d x(0.6, 0.9);
    for (double step = 0.1; step > 1e-10; step *= 0.5) {
      for (bool moved = true; moved;) {
        moved = false;
        for (int k = 0; k < 8; ++k) {
          const double angle = k * std::atan(1.0);
          const Vector2d trial = x + step * Vector2d(std::cos(angle), std::sin(angle));
          if (J(trial) < J(x)) {
            x = trial;
            moved = true;
          }
        }
      }
    }
    return x;
  }
};

const auto radar = [](const Vector2d& x) { return sepcal::differentiate(Radar{}, x); };

}  // namespace

TEST_CASE_TEMPLATE("the fixed point is the state of highest probability", Form, SquareRootForm<2>,
                   JosephForm<2>) {
  const Problem problem;
  Filter<2, Form> once(problem.prior, problem.P);
  once.update(problem.y, radar(once.x()), problem.R);
  Filter<2, Form> filter(problem.prior, problem.P);
  const auto innovation = sepcal::iterated_update(filter, problem.y, radar, problem.R);
  CHECK(innovation.status == FilterStatus::ok);
  const Vector2d expected = problem.lowest();
  MESSAGE("J extended " << problem.J(once.x()) << ", iterated " << problem.J(filter.x())
                        << ", distance from the search " << (filter.x() - expected).norm());
  CHECK((filter.x() - expected).norm() < 1e-6);
  CHECK(problem.J(once.x()) == doctest::Approx(46.367).epsilon(1e-4));
  CHECK(problem.J(filter.x()) == doctest::Approx(0.64853).epsilon(1e-5));

  // S 3.18 at the fixed point, by inverses: P^-1 + H'R^-1 H.
  const Matrix2d H = radar(expected).jacobian;
  const Matrix2d P = (problem.P.inverse() + H.transpose() * problem.R.inverse() * H).inverse();
  CHECK((filter.covariance() - P).norm() < 1e-6 * P.norm());
}

TEST_CASE("an estimate at zero converges, where a step relative to it would not") {
  // Odd outputs and y = 0: eta stays at 0 exactly, so that S 3.16 would divide 0 by 0.
  const auto outputs = [](const Vector2d& x) {
    return sepcal::differentiate(
        [](const auto& eta) {
          using T = std::decay_t<decltype(eta)>::Scalar;
          return Eigen::Vector<T, 1>(eta[0] + eta[1] * eta[1] * eta[1]);
        },
        x);
  };
  using One = Eigen::Matrix<double, 1, 1>;
  Filter<2> filter(Vector2d::Zero(), Matrix2d::Identity());
  const auto innovation =
      sepcal::iterated_update(filter, Eigen::Vector<double, 1>(0.0), outputs, One(0.1));
  CHECK(innovation.status == FilterStatus::ok);
  CHECK(filter.x() == Vector2d::Zero());
}

TEST_CASE("linear outputs need one iteration, also where P is singular or an output is missing") {
  Matrix2d C;
  C << 1.0, 2.0, -1.0, 0.5;
  const auto linear = [&C](const Vector2d& x) { return sepcal::Linearisation<2, 2>{C * x, C}; };
  Matrix2d P;
  P << 4.0, 2.0, 2.0, 1.0;
  const Matrix2d R = Matrix2d::Identity();
  for (const double second : {0.7, std::nan("")}) {
    Filter<2> filter(Vector2d(1.0, 2.0), P);
    Filter<2> expected = filter;
    expected.update(Vector2d(0.3, second), linear(expected.x()), R);
    const auto innovation =
        sepcal::iterated_update(filter, Vector2d(0.3, second), linear, R, {.iterations = 2});
    CHECK(innovation.status == FilterStatus::ok);
    CHECK((filter.x() - expected.x()).norm() < 1e-14);
    CHECK((filter.covariance() - expected.covariance()).norm() < 1e-14);
  }
}

TEST_CASE("the cap is told, and a refusal changes nothing") {
  const Problem problem;
  Filter<2> filter(problem.prior, problem.P);
  CHECK(sepcal::iterated_update(filter, problem.y, radar, problem.R, {.iterations = 2}).status ==
        FilterStatus::not_converged);
  CHECK(filter.x() != problem.prior);
  filter = Filter<2>(problem.prior, problem.P);
  CHECK(sepcal::iterated_update(filter, Vector2d(HUGE_VAL, 0.0), radar, problem.R).status ==
        FilterStatus::refused);
  CHECK(filter.x() == problem.prior);
}

TEST_CASE_TEMPLATE("where nothing was known before, ok means the point of least J too", Form,
                   SquareRootForm<2>, JosephForm<2>) {
  // Ranges to three beacons that don't meet in a point.
  const auto ranges = [](const auto& x) {
    using T = std::decay_t<decltype(x[0])>;
    Eigen::Vector<T, 3> r;
    const double beacons[3][2] = {{0.0, 0.0}, {10.0, 0.0}, {0.0, 10.0}};
    for (int k = 0; k < 3; ++k) r[k] = hypot(x[0] - beacons[k][0], x[1] - beacons[k][1]);
    return r;
  };
  const Eigen::Vector3d y = ranges(Vector2d(3.0, 4.0)) + Eigen::Vector3d(0.5, -0.4, 0.3);
  const Eigen::Matrix3d R = 1e-4 * Eigen::Matrix3d::Identity();
  const Vector2d prior(5.0, 5.0);
  const bool multiplied_out = std::is_same_v<Form, JosephForm<2>>;  // loses P beside R from 1e9 on
  const double variance = multiplied_out ? 1e2 : 1e6;
  Filter<2, Form> filter(prior, Matrix2d(variance * Matrix2d::Identity()));
  const auto at = [&](const Vector2d& x) { return sepcal::differentiate(ranges, x); };
  const auto innovation = sepcal::iterated_update(filter, y, at, R, {.iterations = 200});
  CHECK(innovation.status == FilterStatus::ok);
  // dJ/dx by differences is zero there, in standard deviations.
  const auto J = [&](const Vector2d& x) {
    return 0.5 * (x - prior).squaredNorm() / variance + 0.5 * (y - ranges(x)).squaredNorm() / 1e-4;
  };
  const Vector2d sd = filter.covariance().diagonal().cwiseSqrt();
  for (int k = 0; k < 2; ++k) {
    const Vector2d h = 1e-2 * Vector2d::Unit(k);
    const double slope = (8.0 * (J(filter.x() + 0.5 * h) - J(filter.x() - 0.5 * h)) -
                          (J(filter.x() + h) - J(filter.x() - h))) /
                         (6.0 * h[k]);
    CHECK(std::abs(slope) * sd[k] < 1e-3);
  }
}

}  // namespace iterated_update_test
