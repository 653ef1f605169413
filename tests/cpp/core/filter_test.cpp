// SPDX-License-Identifier: BSD-3-Clause
// The Kalman filter in both forms against conditioning of the stacked Gaussian vector.
#include "sepcal/states/filter.hpp"

#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <numbers>
#include <span>
#include <vector>

#include "sepcal/detail/states/joseph_form.hpp"
#include "sepcal/states/information_form.hpp"
#include "sepcal/states/smoother.hpp"
#include "stacked_system.hpp"

namespace filter_test {

using sepcal::Filter;
using sepcal::FilterStatus;
using sepcal::InformationForm;
using sepcal::JosephForm;
using sepcal::LinearDynamics;
using sepcal::LinearOutputs;
using sepcal::SquareRootForm;
using sepcal::test::Conditioning;
using sepcal::test::Draws;
using sepcal::test::Gaussian;
using sepcal::test::RandomSystem;

namespace {

constexpr int n = RandomSystem::n;
constexpr int m = RandomSystem::m;
constexpr int last = RandomSystem::samples - 1;
using Sample = RandomSystem::Sample;

template <class Form>
auto predict(Filter<n, Form>& filter, const Sample& at) {
  const LinearDynamics<n, RandomSystem::n_w> dynamics{at.Phi, at.Gamma, at.Q};
  return filter.predict(dynamics.from(filter.x(), at.Psi * at.u));
}

template <class Form>
auto update(Filter<n, Form>& filter, const Sample& at) {
  const LinearOutputs<m, n> outputs{at.C};
  return filter.update(at.y, outputs.at(filter.x(), at.D * at.u), at.R);
}

/// The largest difference, in parts of the expected matrix.
template <class Form>
double distance(const Filter<n, Form>& filter, const Gaussian& expected) {
  return std::max((filter.x() - expected.mean).norm() / (1.0 + expected.mean.norm()),
                  (filter.covariance() - expected.covariance).norm() / expected.covariance.norm());
}

/// Filters the whole record; the largest distance of any x(k|k), x(k+1|k) or x(k+i|k) from
/// conditioning.
template <class Form>
double worst_distance(const RandomSystem& system) {
  const Conditioning conditioning(system);
  Filter<n, Form> filter(system.x0, system.P0);
  double worst = 0.0;
  double cost = 0.0;
  for (int k = 0; k <= last; ++k) {
    const auto innovation = update(filter, system.at[static_cast<std::size_t>(k)]);
    CHECK(innovation.status == FilterStatus::ok);
    cost += innovation.cost() + 0.5 * innovation.count * std::log(2.0 * std::numbers::pi);
    worst = std::max(worst, distance(filter, conditioning.state(k, k)));
    Filter<n, Form> ahead = filter;  // S 2.12 and 2.13
    for (int i = k; i < last; ++i) {
      CHECK(predict(ahead, system.at[static_cast<std::size_t>(i)]) == FilterStatus::ok);
      worst = std::max(worst, distance(ahead, conditioning.state(i + 1, k)));
    }
    predict(filter, system.at[static_cast<std::size_t>(k)]);
  }
  CHECK(cost == doctest::Approx(conditioning.minus_log_density()).epsilon(1e-12));
  return worst;
}

}  // namespace

TEST_CASE_TEMPLATE("filter and prediction are conditioning, Q and R correlated, D not zero", Form,
                   SquareRootForm<n>, JosephForm<n>) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const double worst = worst_distance<Form>(RandomSystem(seed));
    MESSAGE("conditioning, seed " << seed << ": " << worst);
    CHECK(worst < 1e-10);
  }
}

TEST_CASE_TEMPLATE("outputs that are missing are left out, one, both or all", Form,
                   SquareRootForm<n>, JosephForm<n>) {
  for (const std::uint64_t seed : {6U, 7U, 8U}) {
    RandomSystem system(seed);
    system.lose(0, 1);
    system.lose(2, 0);
    system.lose(3, 0);
    system.lose(3, 1);
    CHECK(worst_distance<Form>(system) < 1e-10);
    for (int k = 0; k <= last; ++k) {
      for (int j = 0; j < m; ++j) system.lose(k, j);
    }
    Filter<n, Form> filter(system.x0, system.P0);
    const Conditioning conditioning(system);
    for (int k = 0; k < last; ++k) {
      const auto innovation = update(filter, system.at[static_cast<std::size_t>(k)]);
      CHECK(innovation.count == 0);
      CHECK(innovation.cost() == 0.0);
      predict(filter, system.at[static_cast<std::size_t>(k)]);
      CHECK(distance(filter, conditioning.state(k + 1, -1)) < 1e-12);
    }
  }
}

TEST_CASE("singular R, Q_d and P are allowed: a noiseless output is met exactly") {
  const RandomSystem system(9);
  Sample at = system.at[0];
  at.R.setZero();
  at.Q << 1.0, 2.0, 2.0, 4.0;
  Filter<n> filter(system.x0, system.P0);
  CHECK(update(filter, at).status == FilterStatus::ok);
  CHECK((at.C * filter.x() + at.D * at.u - at.y).norm() < 1e-12);
  CHECK((at.C * filter.covariance() * at.C.transpose()).norm() < 1e-12);
  const Eigen::Matrix3d P = filter.covariance();
  predict(filter, at);
  const Eigen::Matrix3d expected =
      at.Phi * P * at.Phi.transpose() + at.Gamma * at.Q * at.Gamma.transpose();
  CHECK((filter.covariance() - expected).norm() < 1e-13 * expected.norm());
}

TEST_CASE_TEMPLATE("what can't be used is refused and changes nothing", Form, SquareRootForm<n>,
                   JosephForm<n>) {
  const RandomSystem system(10);
  const Filter<n, Form> start(system.x0, system.P0);
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(), INFINITY};
  const auto unchanged = [&start](const Filter<n, Form>& filter) {
    return filter.x() == start.x() && filter.covariance() == start.covariance();
  };
  for (const double value : bad) {
    Filter<n, Form> filter = start;
    Sample at = system.at[0];
    at.Phi(1, 2) = value;
    CHECK(predict(filter, at) == FilterStatus::refused);
    at = system.at[0];
    at.Q(0, 1) = value;
    CHECK(predict(filter, at) == FilterStatus::refused);
    at = system.at[0];
    at.C(0, 0) = value;
    CHECK(update(filter, at).status == FilterStatus::refused);
    at = system.at[0];
    at.R(0, 0) = value;
    CHECK(update(filter, at).status == FilterStatus::refused);
    CHECK(unchanged(filter));
  }
  Filter<n, Form> filter = start;
  Sample at = system.at[0];
  at.y[0] = INFINITY;
  CHECK(update(filter, at).status == FilterStatus::refused);
  at = system.at[0];
  at.R << 1.0, 2.0, 2.0, 1.0;  // eigenvalues 3 and -1
  at.C.setZero();
  CHECK(update(filter, at).status == FilterStatus::refused);
  CHECK(unchanged(filter));
}

TEST_CASE_TEMPLATE("covariances that are none are refused", Form, SquareRootForm<2>, JosephForm<2>,
                   InformationForm<2>) {
  using Eigen::Matrix2d;
  Filter<2, Form> filter(Eigen::Vector2d(1.0, 2.0), Matrix2d(Matrix2d::Identity()));
  Matrix2d bad = Matrix2d::Identity();
  bad(1, 1) = -0.5;  // P + bad is still positive
  CHECK(filter.predict(sepcal::Transition<2, 2>{
            filter.x(), Matrix2d::Identity(), Matrix2d::Identity(), bad}) == FilterStatus::refused);
  CHECK(filter
            .update(Eigen::Vector2d(0.0, 0.0),
                    sepcal::Linearisation<2, 2>{filter.x(), Matrix2d::Identity()}, bad)
            .status == FilterStatus::refused);
  CHECK(filter.covariance() == Matrix2d::Identity());
}

TEST_CASE_TEMPLATE("units of the states are no singularity", Form, SquareRootForm<3>, JosephForm<3>,
                   InformationForm<3>) {
  using Eigen::Matrix3d;
  Matrix3d Phi;
  Phi << 0.9, 0.1, 0.0, -0.3, 0.8, 0.1, 0.05, 0.0, 0.95;
  const Matrix3d Q = 0.01 * Matrix3d::Identity();
  const Eigen::Vector3d units(1e9, 1.0, 1e-9);
  const Eigen::Vector3d back = units.cwiseInverse();
  Filter<3> expected(Eigen::Vector3d(1.0, 2.0, 3.0), Matrix3d(Matrix3d::Identity()));
  Filter<3, Form> filter(Eigen::Vector3d(units.cwiseProduct(expected.x())),
                         Matrix3d(units.cwiseAbs2().asDiagonal()));
  for (int k = 0; k < 5; ++k) {
    expected.predict(sepcal::Transition<3, 3>{Eigen::Vector3d(Phi * expected.x()), Phi,
                                              Matrix3d::Identity(), Q});
    CHECK(filter.predict(
              sepcal::Transition<3, 3>{Eigen::Vector3d(units.cwiseProduct(expected.x())),
                                       Matrix3d(units.asDiagonal() * Phi * back.asDiagonal()),
                                       Matrix3d(units.asDiagonal()), Q}) == FilterStatus::ok);
    const Matrix3d P = back.asDiagonal() * filter.covariance() * back.asDiagonal();
    CHECK((P - expected.covariance()).norm() < 1e-12 * P.norm());
  }
}

TEST_CASE("P falls while predicting where Phi damps more than Q_d brings") {
  using One = Eigen::Matrix<double, 1, 1>;
  const LinearDynamics<1, 1> damped{One(0.5), One(1.0), One(0.01)};
  Filter<1> filter(Eigen::Vector<double, 1>(0.0), One(1.0));
  for (const double expected : {0.26, 0.075, 0.02875, 0.0171875}) {
    filter.predict(damped.from(filter.x(), Eigen::Vector<double, 1>(0.0)));
    CHECK(filter.covariance()(0, 0) == doctest::Approx(expected).epsilon(1e-13));
  }
}

TEST_CASE("P(0) = 1e10 and a sensor of 1e-5: the square root keeps the covariance") {
  constexpr int states = 3;
  constexpr int rows = 50;
  constexpr double r = 1e-5;
  Draws draws(11);
  const Eigen::MatrixXd H = draws.normal_matrix(rows, states);
  const Eigen::Vector3d truth(1.0, -2.0, 3.0);
  const Eigen::Matrix3d expected = (H.transpose() * H).inverse() * r * r;
  const auto error = [&](auto filter) {
    for (int k = 0; k < rows; ++k) {
      const Eigen::Matrix<double, 1, states> row = H.row(k);
      filter.update(Eigen::Vector<double, 1>(row * truth + r * draws.normal()),
                    LinearOutputs<1, states>{row}.at(filter.x(), Eigen::Vector<double, 1>(0.0)),
                    Eigen::Matrix<double, 1, 1>(r * r));
    }
    const Eigen::Matrix3d P = filter.covariance();
    const double smallest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(P).eigenvalues()[0];
    return std::pair((P - expected).norm() / expected.norm(), smallest);
  };
  const Eigen::Matrix3d P0 = 1e10 * Eigen::Matrix3d::Identity();
  const auto [root_error, root_smallest] = error(Filter<states>(Eigen::Vector3d::Zero(), P0));
  CHECK(root_error < 1e-5);
  CHECK(root_smallest > 0.0);
  const auto [joseph_error, joseph_smallest] =
      error(Filter<states, JosephForm<states>>(Eigen::Vector3d::Zero(), P0));
  MESSAGE("relative error of P, square root: " << root_error << ", Joseph: " << joseph_error
                                               << ", smallest eigenvalues " << root_smallest << ", "
                                               << joseph_smallest);
}

TEST_CASE("sizes that are known at run time give the same filter, smoother and recursion") {
  using Eigen::Dynamic;
  RandomSystem system(6);
  system.lose(2, 1);
  Filter<n> fixed(system.x0, system.P0);
  Filter<Dynamic> free(system.x0, system.P0);
  Filter<Dynamic, JosephForm<Dynamic>> joseph(system.x0, system.P0);
  std::vector<sepcal::Stage<n, RandomSystem::n_w>> pass;
  std::vector<sepcal::Stage<Dynamic, Dynamic>> free_pass;
  for (const Sample& at : system.at) {
    const auto innovation = update(fixed, at);
    const sepcal::Linearisation<Dynamic, Dynamic> expected{at.C * free.x() + at.D * at.u, at.C};
    const auto other = free.update<Dynamic>(at.y, expected, at.R);
    joseph.update<Dynamic>(at.y, {at.C * joseph.x() + at.D * at.u, at.C}, at.R);
    CHECK(other.cost() == doctest::Approx(innovation.cost()).epsilon(1e-13));
    CHECK((free.covariance() - joseph.covariance()).norm() < 1e-11 * joseph.covariance().norm());
    pass.push_back(
        {fixed.estimate(), LinearDynamics<n, RandomSystem::n_w>{at.Phi, at.Gamma, at.Q}.from(
                               fixed.x(), at.Psi * at.u)});
    free_pass.push_back({free.estimate(), {pass.back().next.x, at.Phi, at.Gamma, at.Q}});
    fixed.predict(pass.back().next);
    free.predict(free_pass.back().next);
    joseph.predict(free_pass.back().next);
    CHECK((free.x() - fixed.x()).norm() < 1e-13 * fixed.x().norm());
  }
  std::vector<sepcal::Smoothed<n, RandomSystem::n_w>> smoothed(pass.size());
  std::vector<sepcal::Smoothed<Dynamic, Dynamic>> free_smoothed(pass.size());
  sepcal::smooth(pass, smoothed);
  sepcal::smooth(free_pass, free_smoothed);
  for (std::size_t k = 0; k < pass.size(); ++k) {
    CHECK((free_smoothed[k].x - smoothed[k].x).norm() < 1e-12 * (1 + smoothed[k].x.norm()));
    CHECK((free_smoothed[k].P - smoothed[k].P).norm() < 1e-12 * smoothed[k].P.norm());
    CHECK((free_smoothed[k].w - smoothed[k].w).norm() < 1e-12 * (1 + smoothed[k].w.norm()));
    CHECK((free_smoothed[k].Q - smoothed[k].Q).norm() < 1e-12 * smoothed[k].Q.norm());
  }
}

}  // namespace filter_test
