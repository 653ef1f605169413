// SPDX-License-Identifier: BSD-3-Clause
// Jumps of parameters: exact where nothing is noisy, and beside a filter that knows when to open.
#include "sepcal/states/change_test.hpp"

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "draws.hpp"
#include "sepcal/states/information_form.hpp"

namespace change_test_test {

using sepcal::ChangeStatus;
using sepcal::ChangeTest;
using sepcal::ChangeTestOptions;
using sepcal::Filter;
using sepcal::InformationForm;
using sepcal::Jump;
using sepcal::LinearDynamics;
using sepcal::Linearisation;
using sepcal::SquareRootForm;
using sepcal::Transition;
using sepcal::test::Draws;

namespace {

using State = Eigen::Vector<double, 4>;  // x_1, x_2, then two parameters that drive them
using Square = Eigen::Matrix<double, 4, 4>;
using Outputs = Eigen::Vector2d;
using Derivative = Eigen::Matrix<double, 2, 4>;

constexpr int onsets = 5;
constexpr int rows_between = 10;

/// Another Phi and C every row; parameters stay.
struct Plant {
  explicit Plant(std::uint64_t seed) : draws(seed) {}

  void next() {
    Phi.setIdentity();
    Phi.topRows<2>() = 0.5 * draws.normal_matrix(2, 4);
    C = draws.normal_matrix(2, 4);
  }

  Draws draws;
  Square Phi = Square::Identity();
  Derivative C = Derivative::Zero();
};

struct Followed {
  State truth;
  State estimate;
  Square P;
  Square P_of_open;  // of the filter that opened at the onset
  Jump<4, 2> jump;
  int found = 0;
};

/// A noise-free record of 100 rows whose parameters jump after row 40, from a start that is right.
template <class Form>
Followed run(const Eigen::Vector2d& by, bool one_is_missing) {
  Plant plant(7);
  const Square P_0 = 0.5 * Square::Identity();
  State truth(0.3, -0.2, 1.0, 2.0);
  Filter<4, Form> filter(truth, P_0);
  Filter<4> open(truth, P_0);
  ChangeTest<4, 2, double, onsets> changes(
      {.rows_between = rows_between, .confirm = 12, .patience = 20, .nonlinear = 0.0});
  const Eigen::Matrix2d R = 1e-4 * Eigen::Matrix2d::Identity();
  const Square Q = 1e-6 * Eigen::Vector4d(1, 1, 0, 0).asDiagonal();
  Followed found;
  for (int row = 1; row <= 100; ++row) {
    plant.next();
    Outputs z = plant.C * truth;
    if (one_is_missing && row % 3 == 0) z[0] = std::numeric_limits<double>::quiet_NaN();
    const Square P = filter.covariance();
    const auto innovation = filter.update(z, Linearisation<2, 4>{plant.C * filter.x(), plant.C}, R);
    open.update(z, Linearisation<2, 4>{plant.C * open.x(), plant.C}, R);
    const ChangeStatus status = changes.update(P, plant.C, z, innovation);
    CHECK((status == ChangeStatus::holds || row > 40));
    if (status == ChangeStatus::changed) {
      found.jump = changes.jump();
      follow(filter, found.jump);
      found.truth = truth;
      found.estimate = filter.x();
      found.P = filter.covariance();
      found.P_of_open = open.covariance();
      found.found = row;
      return found;
    }
    Square opens = Square::Zero();
    if (row == 40) {
      truth.tail<2>() += by;
      for (int j = 0; j < 2; ++j) opens(2 + j, 2 + j) = by[j] == 0.0 ? 0.0 : 1e6;
      open = Filter<4>(open.x(), Square(open.covariance() + opens));
    }
    plant.next();
    const State next = plant.Phi * truth;
    filter.predict(Transition<4, 4>{plant.Phi * filter.x(), plant.Phi, Square::Identity(), Q});
    open.predict(Transition<4, 4>{plant.Phi * open.x(), plant.Phi, Square::Identity(), Q});
    changes.predict(plant.Phi);
    truth = next;
  }
  return found;
}

template <class Form>
void check_exact(bool one_is_missing) {
  for (const Eigen::Vector2d& by :
       {Eigen::Vector2d(0.5, 0.0), Eigen::Vector2d(0.0, -0.7), Eigen::Vector2d(0.4, 0.6)}) {
    CAPTURE(by.transpose());
    const Followed found = run<Form>(by, one_is_missing);
    REQUIRE(found.found > 40);
    CHECK(found.jump.rows == found.found - 40);
    CHECK(found.jump.count == (by.array() != 0.0).count());
    CHECK((found.jump.size - by).norm() < 1e-7);
    CHECK((found.estimate - found.truth).norm() < 1e-7);
    CHECK((found.P - found.P_of_open).norm() < 1e-5 * found.P_of_open.norm());
  }
}

}  // namespace

TEST_CASE("a jump of a linear system is found exactly, and the filter is that which knew of it") {
  check_exact<SquareRootForm<4>>(false);
  check_exact<SquareRootForm<4>>(true);
  check_exact<InformationForm<4>>(false);
}

TEST_CASE("squares of scores are chi squared where nothing jumps, and alarms as rare as they say") {
  // A constant in white noise, 150 records of 1000 rows: chance of 30 or more is 4e-8 a look.
  // With noise of twice the size the squares are four times theirs, and the test learns it.
  int alarms = 0;
  double scatter = 0.0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    Draws draws(1000 + seed);
    Filter<1> filter(Eigen::Vector<double, 1>(0.0), Eigen::Matrix<double, 1, 1>(1e-4));
    ChangeTest<1, 1> changes({.alarm = 30.0});
    ChangeTest<1, 1> learns({.alarm = 1e9});
    for (int row = 0; row < 1000; ++row) {
      const Eigen::Vector<double, 1> z(draws.normal_matrix(1, 1)(0, 0));
      const Eigen::Matrix<double, 1, 1> one(1.0);
      const Eigen::Matrix<double, 1, 1> P = filter.covariance();
      const Linearisation<1, 1> expected{filter.x(), one};
      const auto innovation = filter.update<1>(z, expected, one);
      auto twice = innovation;
      twice.w *= 2.0;
      alarms += changes.update<1>(P, one, z, innovation) == ChangeStatus::changed ? 1 : 0;
      learns.update<1>(P, one, z, twice);
    }
    scatter += learns.inflation() / 150.0;
  }
  CHECK(alarms == 0);
  // Squares of one window, 4 on the average, beside the four of size 1 that are taken as seen:
  // (4 + 4) / 5.
  CHECK(std::abs(scatter - 1.6) < 0.2);
}

TEST_CASE("an outlier is no jump, and no alarm where it is clipped") {
  Draws draws(3);
  Filter<1> filter(Eigen::Vector<double, 1>(0.0), Eigen::Matrix<double, 1, 1>(1e-4));
  ChangeTest<1, 1> changes;
  ChangeTest<1, 1> unclipped({.clip = 1e9});
  bool suspected = false;
  for (int row = 0; row < 2000; ++row) {
    Eigen::Vector<double, 1> z(draws.normal_matrix(1, 1)(0, 0));
    if (row % 400 == 100) z[0] += 12.0;
    const Eigen::Matrix<double, 1, 1> one(1.0);
    const Eigen::Matrix<double, 1, 1> P = filter.covariance();
    const auto innovation = filter.update<1>(z, Linearisation<1, 1>{filter.x(), one}, one);
    CHECK(changes.update<1>(P, one, z, innovation) == ChangeStatus::holds);
    const ChangeStatus status = unclipped.update<1>(P, one, z, innovation);
    CHECK(status != ChangeStatus::changed);
    suspected = suspected || status == ChangeStatus::suspected;
  }
  CHECK(suspected);
}

}  // namespace change_test_test
